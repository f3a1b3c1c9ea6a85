// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

namespace stillhand::recording {

/// Limits of one file; beyond them the recording continues in the next file.
struct RotationLimits {
  std::uint64_t max_bytes = 0;  ///< [B] of one file, 0: no limit
  std::int64_t max_ns = 0;      ///< [ns] of one file, 0: no limit
};

/// True if the next message belongs to a new file.  @param age_ns  time since the first message of
/// the file.
constexpr bool is_full(const RotationLimits& limits, std::uint64_t bytes,
                       std::int64_t age_ns) noexcept {
  return (limits.max_bytes > 0 && bytes >= limits.max_bytes) ||
         (limits.max_ns > 0 && age_ns >= limits.max_ns);
}

/// Name of part `number`, from 1: "run.mcap", "run.0002.mcap", "run.0003.mcap".
std::string part_name(const std::string& path, std::uint32_t number);

}  // namespace stillhand::recording

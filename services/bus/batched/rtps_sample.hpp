// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace stillhand::runtime {

/// The sample of a datagram that holds exactly one.
struct RtpsSample {
  std::array<std::byte, 12> destination{};  ///< GUID prefix of the addressed participant; 0: all
  std::array<std::byte, 16> writer{};       ///< GUID
  std::int64_t sequence = 0;                ///< [-] the writer counts from 1
  std::int32_t sent_s = 0;                  ///< [s] system clock of the writer's host, whole
  std::uint32_t sent_fraction = 0;          ///< [2^-32 s]
  std::span<const std::byte> bytes;         ///< CDR with encapsulation header, inside the datagram
};

/// The sample of an RTPS message that holds one DATA with a time stamp and no submessage that needs
/// an answer, which is how a best-effort writer sends a sample; vendor-specific submessages are
/// skipped.  RTPS 2.3, 8.3.7 and 9.4.  nullopt for every other message, which is left to Fast DDS:
/// discovery, heartbeats, fragments, disposed instances, protected messages, other byte orders, and
/// bytes that are not RTPS.  Pure.
std::optional<RtpsSample> only_sample(std::span<const std::byte> datagram) noexcept;

}  // namespace stillhand::runtime

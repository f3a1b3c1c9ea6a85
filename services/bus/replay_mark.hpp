// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>
#include <vector>

namespace stillhand::runtime {

/// User data (DDS USER_DATA) of every participant and writer whose samples come from a recording or
/// answer one.
inline constexpr std::string_view kReplayMark = "stillhand-replay";

inline std::vector<std::uint8_t> replay_mark() { return {kReplayMark.begin(), kReplayMark.end()}; }

inline bool is_replay_mark(const std::vector<std::uint8_t>& user_data) {
  return user_data.size() >= kReplayMark.size() &&
         std::equal(kReplayMark.begin(), kReplayMark.end(), user_data.begin());
}

}  // namespace stillhand::runtime

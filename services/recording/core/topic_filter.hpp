// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/recording/core/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// `*` stands for any run of characters, a slash included, `?` for any one; the rest for itself.
bool matches_pattern(std::string_view pattern, std::string_view text) noexcept;

/// Which topics are wanted: those that match an allow pattern (all without one) and no block
/// pattern.  Pure.
struct TopicFilter {
  std::vector<std::string> allow;
  std::vector<std::string> block;

  [[nodiscard]] bool wants(std::string_view topic) const noexcept;
};

/// "one of a, b": every topic of a recording, for messages on a name that is none of them.
std::string one_of_topics(const std::map<ChannelId, Channel>& channels);

}  // namespace stillhand::recording

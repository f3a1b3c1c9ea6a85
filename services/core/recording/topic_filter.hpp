// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// `*` matches any run of characters, including a slash; `?` matches any one character; every other
/// character matches itself.
bool matches_pattern(std::string_view pattern, std::string_view text) noexcept;

/// Selection of topics.  A topic is wanted if it matches an allow pattern (or none is given) and
/// matches no block pattern.  Pure.
struct TopicFilter {
  std::vector<std::string> allow;
  std::vector<std::string> block;

  [[nodiscard]] bool wants(std::string_view topic) const noexcept;
};

/// "one of a, b" with every topic of a recording, for messages on an unknown name.
std::string one_of_topics(const std::map<ChannelId, Channel>& channels);

/// @throws ConfigError that names `option`, for a pattern that no topic of a recording matches
void require_each_matches(const std::vector<std::string>& patterns, const std::string& option,
                          const std::map<ChannelId, Channel>& channels);

}  // namespace stillhand::recording

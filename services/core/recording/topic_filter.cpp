// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/topic_filter.hpp"

#include <algorithm>
#include <set>

#include "services/core/contract/config_error.hpp"

namespace stillhand::recording {

// If the text after the newest star does not match, the star takes one more character.  The time is
// linear in the text for each star, without recursion.
bool matches_pattern(std::string_view pattern, std::string_view text) noexcept {
  std::size_t p = 0;
  std::size_t t = 0;
  std::size_t star = std::string_view::npos;
  std::size_t taken = 0;
  while (t < text.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      taken = t;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == text[t])) {
      ++p;
      ++t;
    } else if (star != std::string_view::npos) {
      p = star + 1;
      t = ++taken;
    } else {
      return false;
    }
  }
  while (p < pattern.size() && pattern[p] == '*') ++p;
  return p == pattern.size();
}

bool TopicFilter::wants(std::string_view topic) const noexcept {
  const auto matches = [topic](const std::string& pattern) {
    return matches_pattern(pattern, topic);
  };
  return (allow.empty() || std::ranges::any_of(allow, matches)) &&
         std::ranges::none_of(block, matches);
}

std::string one_of_topics(const std::map<ChannelId, Channel>& channels) {
  std::set<std::string> topics;  // each writer of a topic has a channel
  for (const auto& [id, channel] : channels) topics.insert(channel.topic);
  std::string text;
  for (const std::string& topic : topics) text += (text.empty() ? "one of " : ", ") + topic;
  return text.empty() ? "a recording with topics" : text;
}

void require_each_matches(const std::vector<std::string>& patterns, const std::string& option,
                          const std::map<ChannelId, Channel>& channels) {
  for (const std::string& pattern : patterns) {
    if (std::ranges::none_of(channels, [&pattern](const auto& channel) {
          return matches_pattern(pattern, channel.second.topic);
        })) {
      throw ConfigError(option, pattern + ", which no topic matches", one_of_topics(channels));
    }
  }
}

}  // namespace stillhand::recording

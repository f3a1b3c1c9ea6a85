// SPDX-License-Identifier: Apache-2.0
#include "services/messages/recording/named_writers.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "idl/cdr.hpp"
#include "idl/session.h"
#include "idl/topics.hpp"

namespace stillhand::recording {
namespace {

// 24 hexadecimal digits; "" of a channel without its writer.
std::string participant_of(const Channel& channel) {
  const auto found = channel.metadata.find("writer");
  if (found == channel.metadata.end()) return {};
  std::string text = found->second.substr(0, found->second.find('|'));
  std::erase(text, '.');
  return text;
}

class NamedWriters {
 public:
  // As a process of the session does (services/bus, Sources::take).
  void take(const MessageView& view) {
    stillhand_msgs::SessionSources message;
    if (!from_cdr(view.bytes, message)) return;
    decltype(participants_) named;
    for (const stillhand_msgs::NamedSource& source : message.sources()) {
      named[source.service().c_str()] = source.participant().c_str();
    }
    if (named["experiment"] != participant_of(view.channel)) return;
    participants_ = std::move(named);
    admitted_.clear();
  }

  bool admits(const Channel& channel) {
    const auto [known, first] = admitted_.try_emplace(channel.id, true);
    if (first) known->second = judge(channel);
    return known->second;
  }

 private:
  [[nodiscard]] bool judge(const Channel& channel) const {
    const topics::Topic* row = topics::find(channel.topic);
    const std::string writer = participant_of(channel);
    if (row == nullptr || row->writers.size() != 1 || writer.empty()) return true;
    const auto named = participants_.find(row->writers.front());
    return named == participants_.end() || named->second == writer;
  }

  std::map<std::string, std::string, std::less<>> participants_;  // by service
  std::map<ChannelId, bool> admitted_;
};

}  // namespace

Status for_each_session_message(McapReader& reader, const MessageFilter& filter,
                                const std::function<bool(const MessageView&)>& take) {
  const std::string naming(topics::kSessionSources.name);
  MessageFilter with_naming = filter;
  const bool all = filter.topics.empty();
  const bool asked = all || std::ranges::find(filter.topics, naming) != filter.topics.end();
  if (!asked) with_naming.topics.push_back(naming);
  NamedWriters named;
  return reader.for_each_message(with_naming, [&](const MessageView& view) {
    if (view.channel.topic == naming) {
      named.take(view);
      if (!asked) return true;
    }
    return !named.admits(view.channel) || take(view);
  });
}

}  // namespace stillhand::recording

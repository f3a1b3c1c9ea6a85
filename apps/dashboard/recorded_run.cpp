// SPDX-License-Identifier: Apache-2.0
#include "dashboard/recorded_run.hpp"

#include <algorithm>
#include <map>

#include "contract/config_error.hpp"
#include "recorder/open_recording.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::int64_t kStep_ns = 100'000'000;
constexpr std::int64_t kLongest_ns = 60'000'000'000;  // what a wrong log time may cost

Source source_of(const recording::MessageView& message) {
  const auto text = [&](const char* key) {
    const auto found = message.channel.metadata.find(key);
    return found == message.channel.metadata.end() ? std::string() : found->second;
  };
  return {message.channel.topic, message.schema == nullptr ? "" : message.schema->name,
          text("participant"), text("replayed") == "true"};
}

}  // namespace

std::int64_t feed_recording(const std::string& file, MessageFeed& feed,
                            const std::function<bool()>& stopped) {
  recorder::OpenRecording opened(file, stopped);
  std::map<recording::ChannelId, std::uint32_t> sources;
  std::int64_t newest_ns = 0, stepped_ns = 0;
  std::uint64_t messages = 0;
  recorder::check(opened.reader.for_each_message({}, [&](const recording::MessageView& message) {
    auto known = sources.find(message.channel.id);
    if (known == sources.end()) {
      known = sources.emplace(message.channel.id, feed.add(source_of(message))).first;
    }
    const auto at_ns = static_cast<std::int64_t>(message.log_time_ns);
    newest_ns = std::max(newest_ns, at_ns);
    // Time goes on between messages too; a step a tenth of a second, as on the bus.
    if (stepped_ns == 0 || at_ns - stepped_ns > kLongest_ns) stepped_ns = at_ns;
    for (; stepped_ns + kStep_ns <= at_ns; stepped_ns += kStep_ns) feed.step(stepped_ns + kStep_ns);
    feed.take({known->second, message.sequence, static_cast<std::int64_t>(message.publish_time_ns),
               at_ns, message.bytes});
    ++messages;
    return true;
  }));
  opened.tell_loss(messages);
  if (messages == 0) throw ConfigError(file, "no message", "a recording of a session");
  feed.step(newest_ns);
  return newest_ns;
}

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/recorded_run.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string_view>

#include "apps/dashboard/feed/words.hpp"
#include "services/bus/trial_codec.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/time_difference.hpp"
#include "services/core/contract/units.hpp"

namespace stillhand::dashboard {

namespace {

constexpr std::int64_t kStep_ns = kSecond_ns / 10;
constexpr std::int64_t kLongest_ns = 60 * kSecond_ns;  // bounds the cost of a wrong log time

Source source_of(const recording::MessageView& message) {
  const auto text = [&](const char* key) {
    const auto found = message.channel.metadata.find(key);
    return found == message.channel.metadata.end() ? std::string() : found->second;
  };
  return {message.channel.topic, message.schema == nullptr ? "" : message.schema->name,
          text("participant"), text("replayed") == "true"};
}

// A page of a rig that is not there would be a healthy one: nothing is late on it.
[[noreturn]] void refuse_rig(const std::string& file, std::uint32_t rig,
                             const std::map<recording::ChannelId, recording::Channel>& channels) {
  std::set<std::string> rigs;
  for (const auto& [id, channel] : channels) {
    const auto writer = channel.metadata.find("participant");
    if (writer == channel.metadata.end() || !writer->second.starts_with("stillhand/")) continue;
    const std::string behind = writer->second.substr(std::string_view("stillhand/").size());
    const std::string number = behind.substr(0, behind.find('/'));
    if (number.find_first_not_of("0123456789") == std::string::npos) rigs.insert(number);
  }
  std::string known;
  for (const std::string& each : rigs) known += (known.empty() ? "" : ", ") + each;
  throw ConfigError("--rig", std::to_string(rig) + ", of which " + file + " has no message",
                    known.empty() ? "a recording of a session" : "one of " + known);
}

std::int64_t ns(std::uint64_t time_ns) { return static_cast<std::int64_t>(time_ns); }

}  // namespace

Heard RecordedRun::Playing::take(const recording::MessageView& message) {
  auto known = sources.find(message.channel.id);
  if (known == sources.end()) {
    known = sources.emplace(message.channel.id, feed.add(source_of(message))).first;
  }
  const std::int64_t arrived_ns = ns(message.log_time_ns);
  at_ns = std::max(at_ns, arrived_ns);
  // Time goes on between messages too; a step a tenth of a second, as on the bus.
  if (stepped_ns == 0 || difference_ns(arrived_ns, stepped_ns) > kLongest_ns) {
    stepped_ns = arrived_ns;
  }
  for (; difference_ns(arrived_ns, stepped_ns) >= kStep_ns; stepped_ns += kStep_ns) {
    feed.step(stepped_ns + kStep_ns);
  }
  ++messages;
  return feed.take(
      {known->second, message.sequence, ns(message.publish_time_ns), arrived_ns, message.bytes});
}

RecordedRun::RecordedRun(const std::string& file, const FeedOptions& options,
                         const std::function<bool()>& stopped)
    : opened_(file, stopped),
      timeline_(ns(opened_.reader.statistics().start_time_ns),
                ns(opened_.reader.statistics().end_time_ns)) {
  Playing playing{MessageFeed(options), {}};
  alarm_levels_.resize(playing.feed.health().alarms().size(), Level::kHealthy);
  kept_.reserve(kMostKept + 1);
  kept_.push_back(playing);
  bool of_this_rig = false;
  recordings::check(opened_.reader.for_each_message({}, [&](const recording::MessageView& message) {
    const std::int64_t at_ns = ns(message.log_time_ns);
    keep(playing, at_ns);
    const std::int64_t stepped_ns = playing.stepped_ns;
    const Heard heard = playing.take(message);
    of_this_rig = of_this_rig || heard.topic != nullptr;
    note(heard, playing.feed, at_ns);
    const bool stepped = playing.stepped_ns != stepped_ns;
    if (stepped || heard.verdict.lost > 0 || heard.verdict.sent_late_ns > 0) {
      note_alarms(playing.feed);
    }
    return true;
  }));
  opened_.report_loss(playing.messages);
  if (playing.messages == 0) throw ConfigError(file, "no message", "a recording of a session");
  if (!of_this_rig) refuse_rig(file, options.rig, opened_.reader.channels());
}

// A state is of use where the file is cut cleanly: all that is behind it was also heard later.
void RecordedRun::keep(const Playing& playing, std::int64_t next_ns) {
  while (kept_.size() > 1 && kept_.back().at_ns >= next_ns) kept_.pop_back();
  if (kept_.size() > kMostKept || next_ns <= playing.at_ns) return;
  const std::int64_t apart_ns =
      std::max(kSecond_ns, difference_ns(timeline_.end_ns(), timeline_.begin_ns()) / kMostKept);
  const std::int64_t since_ns = kept_.size() == 1 ? timeline_.begin_ns() : kept_.back().at_ns;
  if (difference_ns(playing.at_ns, since_ns) >= apart_ns) kept_.push_back(playing);
}

namespace {

// Samples between the rig's and this one, along the loop.
int waits_for(const topics::Topic& topic) {
  if (&topic == &topics::kRawSample || &topic == &topics::kRigTruth) return 0;
  if (&topic == &topics::kSensed) return 1;
  return &topic == &topics::kOperatorForce ? 3 : 2;
}

}  // namespace

void RecordedRun::note(const Heard& heard, const MessageFeed& feed, std::int64_t at_ns) {
  if (heard.topic == nullptr) return;
  const Config& config = feed.options().config;
  const std::string topic(heard.topic->name);
  if (heard.verdict.lost > 0) {
    const auto lost_ticks = static_cast<double>(heard.verdict.lost);
    const Threshold threshold{config.lost_warning_ticks, config.lost_critical_ticks};
    timeline_.mark(MarkKind::kLost,
                   {at_ns, threshold.level_of(lost_ticks), 1, topic, "", lost_ticks});
  }
  if (heard.verdict.sent_late_ns > 0) {
    const double late_ms = static_cast<double>(heard.verdict.sent_late_ns) / kNsPerMs;
    const Threshold threshold{config.late_warning_ms, config.late_critical_ms};
    timeline_.mark(MarkKind::kLate, {at_ns, threshold.level_of(late_ms), 1, topic, "", late_ms,
                                     waits_for(*heard.topic)});
  }
  if (heard.topic == &topics::kSensed) {
    timeline_.tick(feed.newest_tick(), at_ns);
  } else if (heard.topic == &topics::kTrialControl && feed.control()) {
    timeline_.announce(runtime::from_idl(*feed.control()), at_ns);
  } else if (heard.topic == &topics::kEvent && !feed.events().empty()) {
    const HeardEvent& newest = feed.events().front();
    if (newest.at_ns != at_ns) return;  // this one was malformed
    const stillhand_msgs::Event& event = newest.event;
    timeline_.mark(MarkKind::kEvent, {at_ns, level_of(event.kind()), 1, event.source().to_string(),
                                      word(event.kind()), 0.0});
  }
}

void RecordedRun::note_alarms(const MessageFeed& feed) {
  const std::vector<NamedAlarm>& alarms = feed.health().alarms();
  for (std::size_t i = 0; i < alarms.size(); ++i) {
    const Alarm& alarm = alarms[i].alarm;
    if (alarm.level() > alarm_levels_[i]) {
      timeline_.mark(MarkKind::kAlarm, {alarm.last_ns(), alarm.level(), 1, alarms[i].subject,
                                        word(alarms[i].watch), alarm.worst()});
    }
    alarm_levels_[i] = alarm.level();
  }
}

std::int64_t RecordedRun::instant_ns(double at_s) const noexcept {
  const std::int64_t length_ns = difference_ns(timeline_.end_ns(), timeline_.begin_ns());
  const double length_s = static_cast<double>(length_ns) / 1e9;
  const double since_s = std::clamp(at_s, 0.0, length_s);
  return timeline_.begin_ns() +
         std::min(std::llround(since_s * 1e9), static_cast<long long>(length_ns));
}

MessageFeed RecordedRun::as_of(std::int64_t at_ns) {
  const auto behind = std::ranges::upper_bound(kept_.begin() + 1, kept_.end(), at_ns, {},
                                               [](const Playing& kept) { return kept.at_ns; });
  Playing playing = *(behind - 1);
  recording::MessageFilter filter;
  if (playing.messages > 0) filter.start_time_ns = static_cast<std::uint64_t>(playing.at_ns) + 1;
  filter.end_time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(at_ns, 0));
  recordings::check(opened_.reader.for_each_message(filter, [&](const auto& message) {
    playing.take(message);
    return true;
  }));
  for (; playing.messages > 0 && difference_ns(at_ns, playing.stepped_ns) >= kStep_ns &&
         difference_ns(at_ns, playing.stepped_ns) <= kLongest_ns;
       playing.stepped_ns += kStep_ns) {
    playing.feed.step(playing.stepped_ns + kStep_ns);
  }
  playing.feed.step(at_ns);
  return std::move(playing.feed);
}

}  // namespace stillhand::dashboard

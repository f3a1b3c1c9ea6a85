// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/rigs.hpp"

#include <utility>

#include "services/core/recording/mcap/sample_clock.hpp"

namespace stillhand::dashboard {

Rigs::Rigs(const FeedOptions& options) : options_(options), shown_(options.rig) {
  feeds_.emplace(shown_, options_);
}

void Rigs::add(const Source& source) {
  const topics::Topic* row = topics::find(source.topic);
  is_stream_.push_back(row != nullptr && row->pattern == topics::Pattern::kStream1khz);
  sources_.push_back(source);
  for (auto& [rig, feed] : feeds_) feed.add(source);
}

// A rig is found by its samples.  A message of no known rig, for example a recorder's status, goes
// to the rig that is shown.
MessageFeed& Rigs::feed_of(std::uint32_t writer, std::uint32_t rig) {
  const auto known = feeds_.find(rig);
  if (known != feeds_.end()) return known->second;
  if (rig == 0 || !is_stream_.at(writer) || feeds_.size() >= kMostRigs) return shown();
  FeedOptions options = options_;
  options.rig = rig;
  options.answers.reset();  // its line has no cost
  MessageFeed& fresh = feeds_.emplace(rig, std::move(options)).first->second;
  for (const Source& source : sources_) fresh.add(source);
  return fresh;
}

void Rigs::take(const Message& message) {
  feed_of(message.source, recording::sample_head(message.bytes).rig).take(message);
}

void Rigs::step(std::int64_t now_ns) {
  for (auto& [rig, feed] : feeds_) feed.step(now_ns);
}

std::vector<RigSummary> Rigs::summaries() const {
  std::vector<RigSummary> all;
  for (const auto& [rig, feed] : feeds_) {
    RigSummary summary;
    summary.rig = rig;
    summary.level = feed.health().level();
    summary.running = feed.health().running();
    for (const TopicHealth& topic : feed.health().topics()) {
      if (topic.plan().deadline_ns == 0) continue;
      summary.samples += topic.samples();
      summary.lost += topic.lost();
    }
    for (const NamedAlarm& each : feed.health().alarms()) {
      if (summary.worst.empty() && each.alarm.level() != Level::kHealthy &&
          each.alarm.level() == summary.level) {
        summary.worst = each.subject;
      }
    }
    if (summary.samples > 0 || rig == shown_) all.push_back(std::move(summary));
  }
  return all;
}

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#include "services/bus/recording/tally.hpp"

#include <algorithm>

#include "idl/topics.hpp"
#include "services/bus/recording/qos_texts.hpp"
#include "services/core/recording/mcap/sample_clock.hpp"

namespace stillhand::recording {

using runtime::FoundWriter;
using runtime::TappedSample;

namespace {

/// True if the samples begin with rig, tick and stamp and have consecutive ticks.
bool counts_ticks(const std::string& type) {
  return std::ranges::any_of(topics::kCatalogue, [&](const topics::Topic* row) {
    return row->type == type && row->pattern == topics::Pattern::kStream1khz;
  });
}

Channel channel_of(const FoundWriter& writer) {
  Channel channel;
  channel.topic = writer.topic;
  channel.message_encoding = kMessageEncoding;
  channel.metadata = qos_texts(writer.qos);
  channel.metadata["writer"] = writer.id;
  channel.metadata["participant"] = writer.participant;
  if (!writer.profile.empty()) channel.metadata["qos_profile"] = writer.profile;
  if (writer.replayed) channel.metadata["replayed"] = "true";
  if (!writer.user_data.empty()) channel.metadata["user_data"] = writer.user_data;
  return channel;
}

}  // namespace

void Tally::take(const FoundWriter& writer, const TappedSample& sample) {
  const std::lock_guard lock(mutex_);
  auto known = sources_.find(sample.writer);
  if (known == sources_.end()) {
    Source source;
    source.topic = writer.topic;
    source.has_ticks = counts_ticks(writer.type);
    source.channel = tape_->add_channel(channel_of(writer), writer.type, writer.idl);
    known = sources_.emplace(sample.writer, std::move(source)).first;
  }
  Source& source = known->second;
  source.count.step(sample.sequence, source.has_ticks ? sample_head(sample.bytes).tick : -1);
  // Of a sample that was lost the time is not known.
  if (source.count.received() > 1 && sample.sequence == source.sequence + 1 &&
      sample.source_ns - source.sent_ns > writer.qos.deadline_ns) {
    ++source.late;
  }
  source.sequence = sample.sequence;
  source.sent_ns = sample.source_ns;
  // MCAP has 32 bits for the sequence; a gap remains visible.
  tape_->put(source.channel, static_cast<std::uint32_t>(sample.sequence), sample.logged_ns,
             sample.source_ns, sample.received_ns, sample.bytes);
}

void Tally::end_instance(std::size_t writer, std::int64_t sequence) {
  const std::lock_guard lock(mutex_);
  const auto known = sources_.find(writer);
  if (known != sources_.end()) known->second.count.end_instance(sequence);
}

std::map<std::string, TopicTally> Tally::topics(const std::vector<FoundWriter>& found) const {
  const std::vector<std::uint64_t> written = tape_->written_by_channel();
  std::map<std::string, TopicTally> all;
  for (const FoundWriter& writer : found) {
    if (!writer.wanted) continue;
    TopicTally& tally = all[writer.topic];
    ++tally.writers;
    tally.type_known = tally.type_known && !writer.idl.empty();
  }
  const std::lock_guard lock(mutex_);
  for (const auto& [number, source] : sources_) {
    TopicTally& tally = all[source.topic];
    tally.received += static_cast<std::uint64_t>(source.count.received());
    tally.lost += static_cast<std::uint64_t>(source.count.lost());
    tally.not_sent += static_cast<std::uint64_t>(source.count.not_sent());
    tally.late += source.late;
    if (source.channel < written.size()) tally.written += written[source.channel];
  }
  return all;
}

std::set<std::string> Tally::heard() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> topics;
  for (const auto& [number, source] : sources_) topics.insert(source.topic);
  return topics;
}

TextMap Tally::texts() const {
  TextMap texts;
  for (const auto& [topic, tally] : topics({})) {
    texts[topic + " received"] = std::to_string(tally.received);
    texts[topic + " lost"] = std::to_string(tally.lost);
    texts[topic + " not_sent"] = std::to_string(tally.not_sent);
    texts[topic + " late"] = std::to_string(tally.late);
    texts[topic + " written"] = std::to_string(tally.written);
  }
  return texts;
}

}  // namespace stillhand::recording

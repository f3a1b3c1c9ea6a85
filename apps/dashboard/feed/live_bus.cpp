// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/feed/live_bus.hpp"

#include <unistd.h>

#include <utility>

namespace stillhand::dashboard {

LiveBus::LiveBus(const LiveOptions& options, Rigs& rigs)
    : rigs_(rigs),
      tap_({.name = "stillhand-dashboard/" + std::to_string(getpid()),
            .domain = options.domain,
            .profiles = options.profiles,
            .security = options.security,
            .wanted = [&rigs](const std::string& topic) { return rigs.shown().wants(topic); },
            .on_sample = [this](const runtime::FoundWriter& writer,
                                const runtime::TappedSample& sample) { take(writer, sample); }}) {}

void LiveBus::take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample) {
  const std::lock_guard lock(mutex_);
  if (filling_.bytes.size() + sample.bytes.size() > kMostBytes) {
    ++dropped_;
    return;
  }
  auto known = number_of_.find(sample.writer);
  if (known == number_of_.end()) {
    new_sources_.push_back({writer.topic, writer.type, writer.participant, writer.replayed});
    const auto number = static_cast<std::uint32_t>(number_of_.size());
    known = number_of_.emplace(sample.writer, number).first;
  }
  filling_.add({known->second, static_cast<std::uint32_t>(sample.sequence),
                static_cast<std::uint64_t>(sample.logged_ns),
                static_cast<std::uint64_t>(sample.source_ns), sample.received_ns, 0, 0},
               sample.bytes);
}

void LiveBus::drain() {
  std::vector<Source> sources;
  {
    const std::lock_guard lock(mutex_);
    std::swap(filling_, draining_);
    std::swap(new_sources_, sources);
  }
  for (const Source& source : sources) rigs_.add(source);
  for (const recording::HeldMessage& held : draining_.messages) {
    rigs_.take({held.channel, held.sequence, static_cast<std::int64_t>(held.publish_time_ns),
                static_cast<std::int64_t>(held.log_time_ns), draining_.content(held)});
  }
  draining_.clear();
}

std::uint64_t LiveBus::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace stillhand::dashboard

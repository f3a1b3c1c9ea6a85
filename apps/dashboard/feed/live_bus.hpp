// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "apps/dashboard/feed/rigs.hpp"
#include "services/bus/tap.hpp"
#include "services/core/recording/held_message.hpp"

namespace stillhand::dashboard {

struct LiveOptions {
  std::uint32_t domain = 0;
  std::filesystem::path profiles;
  std::filesystem::path security;  ///< see runtime::Bus::Options
};

/// Messages of a running bus on their way to the feeds, received from outside of the session.
/// DDS's threads only copy a message into a bounded queue; the thread of the feeds empties it.
class LiveBus {
 public:
  /// @param rigs  outlive this; touched by drain() alone  @throws as runtime::Tap does
  LiveBus(const LiveOptions& options, Rigs& rigs);

  void start() { tap_.start(); }
  /// Feeds the messages since the last call.
  void drain();
  /// Messages that came while the queue was full.
  [[nodiscard]] std::uint64_t dropped() const;
  [[nodiscard]] std::vector<std::string> trouble() const { return tap_.trouble(); }

 private:
  void take(const runtime::FoundWriter& writer, const runtime::TappedSample& sample);

  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;  // of one session: 30 s

  Rigs& rigs_;
  mutable std::mutex mutex_;
  recording::MessageBatch filling_;
  std::vector<Source> new_sources_;
  std::map<std::size_t, std::uint32_t> number_of_;  // by the tap's
  std::uint64_t dropped_ = 0;
  recording::MessageBatch draining_;  // of drain() alone
  runtime::Tap tap_;                  // last: its threads use the members above
};

}  // namespace stillhand::dashboard

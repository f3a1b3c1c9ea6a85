// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "apps/dashboard/feed/message_feed.hpp"

namespace stillhand::dashboard {

/// A rig of this bus in one line.
struct RigSummary {
  std::uint32_t rig = 0;
  Level level = Level::kHealthy;
  bool running = false;
  std::uint64_t samples = 0, lost = 0;  ///< of its 1 kHz topics
  std::string worst;                    ///< topic or process of the worst alarm, or ""
};

/// Every rig of a bus, each with a feed of its own: the one that the page shows, and the others
/// that are found.  One thread.
class Rigs {
 public:
  static constexpr std::size_t kMostRigs = 32;  ///< further rigs are not counted

  /// @param options  of the one that is shown  @throws ConfigError as BusHealth does
  explicit Rigs(const FeedOptions& options);

  [[nodiscard]] MessageFeed& shown() { return feeds_.at(shown_); }
  /// A writer, numbered as MessageFeed::add() does.
  void add(const Source& source);
  void take(const Message& message);
  void step(std::int64_t now_ns);
  /// Of every rig that was heard, by number.
  [[nodiscard]] std::vector<RigSummary> summaries() const;

 private:
  MessageFeed& feed_of(std::uint32_t writer, std::uint32_t rig);

  FeedOptions options_;
  std::uint32_t shown_;
  std::map<std::uint32_t, MessageFeed> feeds_;
  std::vector<Source> sources_;  // for those that are found later
  std::vector<bool> is_stream_;  // of each, whether only a rig's own process writes it
};

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "apps/dashboard/core/timeline.hpp"
#include "apps/dashboard/feed/message_feed.hpp"
#include "apps/recordings/open_recording.hpp"

namespace stillhand::dashboard {

/// A recording, fed as a bus is: the state that a dashboard would have shown at any instant, and
/// the time line of faults and events.
///
/// States on the way are kept, one a second or kMostKept over the whole, so that any instant is
/// reached by feeding at most what lies behind one of them.  Bounded memory: a state takes 1.8 MB.
/// One thread.
class RecordedRun {
 public:
  static constexpr int kMostKept = 32;

  /// Feeds all of it.  @throws ConfigError when it cannot be read; recordings::Interrupted when
  /// `stopped` says so, now or later
  RecordedRun(const std::string& file, const FeedOptions& options,
              const std::function<bool()>& stopped);

  /// The feed after the messages that were heard up to then, in the order of the file; exactly as
  /// if the recording held no others.
  [[nodiscard]] MessageFeed as_of(std::int64_t at_ns);
  /// [ns] since 1970 of an instant [s] since the beginning, within the recording.
  [[nodiscard]] std::int64_t instant_ns(double at_s) const noexcept;
  [[nodiscard]] const Timeline& timeline() const noexcept { return timeline_; }

 private:
  /// A feed on its way through the file.
  struct Playing {
    MessageFeed feed;
    std::map<recording::ChannelId, std::uint32_t> sources;
    std::int64_t stepped_ns = 0;
    std::int64_t at_ns = 0;  ///< newest arrival
    std::uint64_t messages = 0;

    Heard take(const recording::MessageView& message);
  };

  void note(const Heard& heard, const MessageFeed& feed, std::int64_t at_ns);
  void note_alarms(const MessageFeed& feed);
  void keep(const Playing& playing, std::int64_t next_ns);

  recordings::OpenRecording opened_;
  Timeline timeline_;
  std::vector<Level> alarm_levels_;  // as noted last
  std::vector<Playing> kept_;        // the first one is empty
};

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// Where somebody set the clock that the log times of a recording were read from.
struct ClockStep {
  std::uint64_t chunk;    ///< its offset in the file
  std::uint64_t message;  ///< number in the chunk of the first message behind the step
  std::uint64_t at_ns;    ///< [ns] log time of that message, had the clock not been set
  std::int64_t by_ns;     ///< [ns]
};

/// Finds the steps of a recorder's clock, Eq. RC-15.  A 1 kHz sample carries the monotonic clock of
/// its process (stamp), which nobody sets: log time less stamp is the offset of the two clocks and
/// the way to the recorder.
///
///   back      the log time of a writer's sample is before that of its sample before
///   forward   log time less stamp has grown by S, and 0.2 s of stamps later it still has; of a
///             recorder that stood still and takes what has waited, it has not
///
/// A file without such samples shows only steps back, with an error of one message's interval.
/// Pure; one thread; messages in the order of the file.
class ClockStepFinder {
 public:
  /// Least step [ns]: threads of a recorder overtake each other by less.
  static constexpr std::int64_t kLeast_ns = 20'000'000;

  /// @param streams  the file holds channels of 1 kHz samples
  explicit ClockStepFinder(bool streams) : streams_(streams) {}

  /// @param chunk, message  as in ClockStep  @param stream  the channel has 1 kHz samples
  void take(std::uint64_t chunk, std::uint64_t message, ChannelId channel, bool stream,
            std::uint64_t log_time_ns, std::span<const std::byte> bytes);
  /// @param total_ns  [ns] what the clock was set by in all, if it is known: decides on a step
  ///                  forward that the end of the file follows too closely
  [[nodiscard]] std::vector<ClockStep> found(std::optional<std::int64_t> total_ns) const;

 private:
  struct Stream {
    std::int64_t ahead_ns;  // log time less stamp of its newest sample
    std::int64_t log_ns;    // straight
  };
  struct Forward {
    ClockStep step;
    ChannelId channel;
    std::int64_t decided_ns;  // stamp
  };
  void accept(const ClockStep& step);
  [[nodiscard]] bool still_ahead(const Forward& forward, std::int64_t jump_ns) const;

  bool streams_;
  std::map<ChannelId, Stream> newest_;
  std::optional<Forward> forward_;
  std::vector<ClockStep> steps_;
  std::uint64_t shift_ns_ = 0;  // sum of the steps, modulo 2^64
};

}  // namespace stillhand::recording

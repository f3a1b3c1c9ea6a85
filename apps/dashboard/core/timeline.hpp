// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "apps/dashboard/core/alarm.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::dashboard {

enum class MarkKind : std::uint8_t { kLate, kLost, kAlarm, kEvent };
inline constexpr std::size_t kMarkKinds = 4;

/// A fault, or an event of a process, at one instant of a recording.
struct Mark {
  std::int64_t at_ns = 0;  ///< [ns] the first of those that were put together
  Level level = Level::kHealthy;
  std::uint64_t count = 1;
  std::string subject;  ///< topic or process; as the next two of the worst
  std::string what;     ///< an alarm's watch, an event's kind; empty for kLate and kLost
  double amount = 0.0;  ///< [ms], or [ticks] of kLost, or the watch's unit
  /// [-] samples that this one waits for, from the rig's on.  Of two of one level that fall
  /// together the one with fewer is the cause, if it has half of the other's amount.
  int waits_for = 0;
};

/// From the first to the last measured tick of a trial, by the listener's clock.
struct TrialSpan {
  std::int64_t number = -1;
  TrialPhase phase = TrialPhase::kIdle;
  std::int64_t from_ns = 0, to_ns = 0;
};

/// Faults and events of a recording, with their times.  Bounded: marks of one kind that fall into
/// the same 1/2000 of the recording are one mark, at the instant of the first.  Pure: time enters
/// with each call; one thread.
class Timeline {
 public:
  /// @param begin_ns,end_ns  of the recording; marks outside count for its first or last part
  Timeline(std::int64_t begin_ns, std::int64_t end_ns) noexcept
      : begin_ns_(begin_ns), end_ns_(end_ns > begin_ns ? end_ns : begin_ns) {}

  void mark(MarkKind kind, Mark mark);
  /// A trial is announced; the one before is over, if it has not ended yet.
  void announce(const Trial& trial, std::int64_t at_ns);
  /// A sample of the sample clock.
  void tick(Tick tick, std::int64_t at_ns);

  [[nodiscard]] std::int64_t begin_ns() const noexcept { return begin_ns_; }
  [[nodiscard]] std::int64_t end_ns() const noexcept { return end_ns_; }
  /// In the order of time.
  [[nodiscard]] std::vector<Mark> marks(MarkKind kind) const;
  [[nodiscard]] const std::vector<TrialSpan>& trials() const noexcept { return trials_; }

 private:
  static constexpr std::int64_t kParts = 2000;
  static constexpr std::size_t kMostTrials = 1000;

  std::int64_t begin_ns_, end_ns_;
  std::map<std::pair<MarkKind, std::int64_t>, Mark> marks_;
  std::vector<TrialSpan> trials_;
  enum class Stage : std::uint8_t { kNone, kAwaited, kRuns };
  Trial announced_;
  Stage stage_ = Stage::kNone;
};

}  // namespace stillhand::dashboard

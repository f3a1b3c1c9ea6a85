// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/lab/core/stage.hpp"
#include "apps/lab/core/standstill.hpp"
#include "apps/lab/core/trouble.hpp"

namespace stillhand::lab {

/// How a trial went.
struct TrialResult {
  Trial trial;  ///< with the start tick that was announced
  bool completed = false;
  bool stopped = false;           ///< by a request: it is run again
  std::string aborted;            ///< why it was not completed, or empty
  std::vector<EventSeen> events;  ///< during the trial
  Misses misses;                  ///< during the trial
};

/// One trial, from the end of a pause to the end of its force:
///
///   await start -> announce -> await armed -> follow -> see the force out -> look for a death
///
/// A trial that would begin before every process is prepared is announced again, for later.  "Await
/// armed" passes over the next two when a process is not prepared in time.
class TrialRun final : public Stage {
 public:
  TrialRun(const Trial& planned, const Roster& roster, Trouble& trouble);

  Actions step(Seen& seen, std::int64_t now_ns) override;
  /// Valid once over().
  [[nodiscard]] const TrialResult& result() const noexcept { return result_; }

 private:
  enum class At : std::uint8_t { kPaused, kArming, kRunning, kForceZero, kAfterwards, kDeath };

  // Each returns true when it has moved on to another part or to the end.
  bool advance(Seen& seen, std::int64_t now_ns, Actions& actions);
  bool await_start(Seen& seen, std::int64_t now_ns, Actions& actions);
  bool await_armed(Seen& seen, std::int64_t now_ns, Actions& actions);
  bool follow(Seen& seen, std::int64_t now_ns, Actions& actions);
  bool await_force_zero(const Seen& seen, std::int64_t now_ns, Actions& actions);
  bool await_afterwards(Seen& seen, std::int64_t now_ns);
  bool await_death(Seen& seen, std::int64_t now_ns);

  void begin(Seen& seen, std::int64_t now_ns, Actions& actions);
  void announce_idle(Actions& actions);
  bool end_motion(Seen& seen, std::int64_t now_ns, Actions& actions);
  bool look_for_death(Seen& seen, std::int64_t now_ns);
  bool move_on(At at, std::int64_t limit_ns);
  bool end(Seen& seen);
  void postpone(const Seen& seen, Actions& actions);
  [[nodiscard]] bool armed(const Seen& seen, const Member& member) const;
  [[nodiscard]] std::string why_late(const Seen& seen) const;
  [[nodiscard]] Tick first_tick() const;
  [[nodiscard]] std::string why_not_armed(const Seen& seen) const;
  [[nodiscard]] Tick last_tick() const;
  [[nodiscard]] Progress progress(Tick now) const;

  const Roster& roster_;
  Trouble& trouble_;
  TrialResult result_;
  At at_ = At::kPaused;
  std::int64_t limit_ns_;
  bool announced_pause_ = false;
  bool announced_idle_ = false;  // of this trial: its motion ends
  Standstill standstill_;
  bool stopped_ = false;  // the force goes to zero by request: no event reports it
  Tick afterwards_ = 0;   // tick at which the recorder has seen the force's end
  Misses before_;
};

}  // namespace stillhand::lab

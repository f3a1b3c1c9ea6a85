// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/contract/tick.hpp"
#include "services/contract/trial.hpp"

namespace stillhand::cancellation {

/// What the experiment assigns to a trial: the condition, as far as the canceller needs it.
struct Assignment {
  std::int64_t trial = -1;    ///< number of the trial
  bool cancellation = false;  ///< the trial asks for cancellation
  bool mitigation = false;    ///< the trial asks for another mitigation, in place of it
};

/// A mitigation that is made and runs.
struct PreparedMitigation {
  std::int64_t assignment = 0;  ///< number of the one that it was made of; 0: there is none
  Tick in_effect = 0;           ///< first tick at which it can be in full effect
};

/// Whether the canceller is prepared for the newest trial.
enum class Readiness : std::uint8_t {
  kArmed,              ///< prepared
  kUnassigned,         ///< the trial's assignment has not come
  kNoModel,            ///< the trial asks for cancellation, and no model is in use or ready
  kModelTooLate,       ///< the model that is ready may be used only after the trial has begun
  kNoMitigation,       ///< the trial asks for a mitigation that is not prepared
  kMitigationTooLate,  ///< it would not be in full effect at the trial's first measured tick
};

/// Decides when the canceller is armed for a trial and at which samples it cancels.  Trial and
/// assignment come in either order.  A trial that asks for cancellation is armed only with a model:
/// a trial that ran without one would pass for one that was cancelled.
/// Pure; one thread; nothing allocates or throws.
class TrialArming {
 public:
  /// @param trial  sound, see Trial::sound()
  void announce(const Trial& trial) noexcept { trial_ = trial; }
  /// It replaces the one before, of whatever trial.
  void assign(const Assignment& assignment) noexcept {
    assignment_ = assignment;
    ++assignments_;
  }
  /// Number of the newest assignment, from 1 on: a trial's own number can come again.
  [[nodiscard]] std::int64_t newest() const noexcept { return assignments_; }

  /// @param has_model   a model is in use
  /// @param next_model  first tick of a model that is ready but not in use, if there is one
  [[nodiscard]] Readiness readiness(bool has_model, std::optional<Tick> next_model,
                                    const PreparedMitigation& prepared = {}) const noexcept;

  /// True where the trial asks for cancellation at this tick, ramps included.
  [[nodiscard]] bool cancels(Tick tick) const noexcept {
    return assigned() && assignment_->cancellation && tracks(tick);
  }
  /// True from the first tick of the newest trial's first ramp on.
  [[nodiscard]] bool begun(Tick tick) const noexcept {
    return assigned() && tick >= trial_.start_tick - trial_.ramp_ticks;
  }
  /// The same as cancels() for a mitigation, and only with the one that is prepared for the trial.
  [[nodiscard]] bool mitigates(Tick tick, const PreparedMitigation& prepared) const noexcept {
    return assigned() && assignment_->mitigation && mitigation(prepared) == Readiness::kArmed &&
           tracks(tick);
  }

 private:
  /// Of a trial that asks for a mitigation.  Trial 0 is a session's pegged one.
  [[nodiscard]] Readiness mitigation(const PreparedMitigation& prepared) const noexcept {
    if (trial_.number <= 0 || prepared.assignment != assignments_) return Readiness::kNoMitigation;
    return prepared.in_effect <= trial_.start_tick ? Readiness::kArmed
                                                   : Readiness::kMitigationTooLate;
  }
  [[nodiscard]] bool tracks(Tick tick) const noexcept {
    return trial_.phase == TrialPhase::kTracking && trial_.covers(tick);
  }
  [[nodiscard]] bool assigned() const noexcept {
    return assignment_ && assignment_->trial == trial_.number;
  }

  Trial trial_;
  std::optional<Assignment> assignment_;
  std::int64_t assignments_ = 0;
};

}  // namespace stillhand::cancellation

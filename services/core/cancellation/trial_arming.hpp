// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::cancellation {

/// What the experiment assigns to a trial: the condition, as far as the canceller needs it.
struct Assignment {
  std::int64_t trial = -1;    ///< number of the trial
  bool cancellation = false;  ///< the trial asks for cancellation
  bool parts = false;         ///< the trial asks for parts of its own, in place of it
  bool needs_force = false;   ///< which need the model of the force
};

/// Parts of a trial that are made and run.
struct PreparedParts {
  std::int64_t assignment = 0;  ///< number of the one that it was made of; 0: there is none
  Tick in_effect = 0;           ///< first tick at which it can be in full effect
};

/// Whether the process is prepared for the newest trial.
enum class Readiness : std::uint8_t {
  kArmed,              ///< prepared
  kUnassigned,         ///< the trial's assignment has not come
  kNoModel,            ///< the trial needs the model of the force, and none is in use or ready
  kModelTooLate,       ///< the model that is ready may be used only after the trial has begun
  kNoMitigation,       ///< the trial asks for a mitigation that is not prepared
  kMitigationTooLate,  ///< it would not be in full effect at the trial's first measured tick
};

/// Decides when the process is armed for a trial and at which samples it acts.  Trial and
/// assignment come in either order.  A trial that needs the model of the force is armed only with
/// one: a trial that ran without would pass for one that was cancelled. Pure; one thread; nothing
/// allocates or throws.
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
                                    const PreparedParts& prepared = {}) const noexcept;

  /// True where the newest assignment asks for cancellation, and for no parts of its own.
  [[nodiscard]] bool cancels() const noexcept {
    return assignment_ && assignment_->cancellation && !assignment_->parts;
  }
  /// True where the trial asks for a force or a command at this tick, ramps included; with parts of
  /// its own only with those that are prepared for it.
  [[nodiscard]] bool acts(Tick tick, const PreparedParts& prepared) const noexcept {
    return assigned() && tracks(tick) &&
           (assignment_->parts ? made(prepared) == Readiness::kArmed : assignment_->cancellation);
  }
  /// True from the first tick of the newest trial's first ramp on.
  [[nodiscard]] bool begun(Tick tick) const noexcept {
    return assigned() && tick >= trial_.start_tick - trial_.ramp_ticks;
  }

 private:
  /// Of a trial that asks for parts of its own.  Trial 0 is a session's pegged one.
  [[nodiscard]] Readiness made(const PreparedParts& prepared) const noexcept {
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

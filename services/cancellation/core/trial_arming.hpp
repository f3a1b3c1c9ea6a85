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
};

/// Whether the canceller is prepared for the newest trial.
enum class Readiness : std::uint8_t {
  kArmed,         ///< prepared
  kUnassigned,    ///< the trial's assignment has not come
  kNoModel,       ///< the trial asks for cancellation, and no model is in use or ready
  kModelTooLate,  ///< the model that is ready may be used only after the trial has begun
};

/// Decides when the canceller is armed for a trial and at which samples it cancels.  Trial and
/// assignment come in either order.  A trial that asks for cancellation is armed only with a model:
/// a trial that ran without one would pass for one that was cancelled.
/// Pure; one thread; nothing allocates or throws.
class TrialArming {
 public:
  /// @param trial  sound, see Trial::sound()
  void announce(const Trial& trial) noexcept { trial_ = trial; }
  void assign(const Assignment& assignment) noexcept { assignment_ = assignment; }

  /// @param has_model   a model is in use
  /// @param next_model  first tick of a model that is ready but not in use, if there is one
  [[nodiscard]] Readiness readiness(bool has_model, std::optional<Tick> next_model) const noexcept;

  /// True where the trial asks for cancellation at this tick, ramps included.
  [[nodiscard]] bool cancels(Tick tick) const noexcept {
    return assigned() && assignment_->cancellation && trial_.phase == TrialPhase::kTracking &&
           trial_.covers(tick);
  }

 private:
  [[nodiscard]] bool assigned() const noexcept {
    return assignment_ && assignment_->trial == trial_.number;
  }

  Trial trial_;
  std::optional<Assignment> assignment_;
};

}  // namespace stillhand::cancellation

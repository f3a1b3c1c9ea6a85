// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "services/core/contract/tick.hpp"
#include "services/core/contract/trial.hpp"
#include "services/core/signal/multisine.hpp"

namespace stillhand::cancellation {

/// Perturbs the hand in place of cancelling, Eq. CC-17: the force of a multisine over the measured
/// ticks of a trial, risen from zero over the ramp before it and fallen over the ramp after it:
/// w(tick) f(tick - start).
/// Source: METHOD Eq. CC-17.  Pure; force_n() neither allocates nor throws.
class Perturbation {
 public:
  /// @param force  [N] as its accel_m_s2, at 1 kHz; its first sample is that of the trial's start
  explicit Perturbation(signal::Multisine force) : force_(std::move(force)) {}

  /// 0 outside of the trial.
  [[nodiscard]] double force_n(Tick tick, const Trial& trial) const noexcept;

 private:
  signal::Multisine force_;
};

}  // namespace stillhand::cancellation

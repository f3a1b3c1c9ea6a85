// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/cancellation/core/canceller.hpp"
#include "services/contract/trial.hpp"
#include "services/signal/force_envelope.hpp"
#include "services/signal/multisine.hpp"

namespace stillhand::cancellation {

/// Perturbs the hand in place of cancelling, Eq. CC-17: the force of a multisine over the measured
/// ticks of a trial, risen from zero over the ramp before it and fallen over the ramp after it:
///
///   wanted = w(tick) f(tick - start),   force = ForceEnvelope(wanted)   (Eq. SG-6)
///
/// The force leaves zero only while enabled, permitted, inside the trial and with a sound new
/// sample; the envelope is that of cancelling, with the same start-up limits.
/// Source: METHOD Eq. CC-17.  One thread; step() neither allocates nor throws.
class Perturbation {
 public:
  /// @param force  [N] as its accel_m_s2, at 1 kHz; its first sample is that of the trial's start
  Perturbation(signal::Multisine force, const Config& config);

  CancellerOutput step(const CancellerInput& input, const Trial& trial) noexcept;

 private:
  [[nodiscard]] double wanted(Tick tick, const Trial& trial) const noexcept;

  signal::Multisine force_;
  double max_acceleration_m_s2_;
  signal::ForceEnvelope envelope_;
  Tick last_tick_ = -1;
};

}  // namespace stillhand::cancellation

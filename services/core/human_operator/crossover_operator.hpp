// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "services/core/contract/trial.hpp"
#include "services/core/human_operator/crossover_config.hpp"
#include "services/core/human_operator/fast_error.hpp"
#include "services/core/human_operator/operator_io.hpp"
#include "services/core/human_operator/remnant.hpp"
#include "services/core/signal/delay_line.hpp"
#include "services/core/signal/force_envelope.hpp"
#include "services/core/signal/running_rms.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::human_operator {

/// Simulated subject after McRuer's crossover model:
///   u' = w_c (e(t - T_p) + v(t))         wanted cursor, v the remnant (HO-4), w_c from HO-5
///   x  = muscle(u) / 6                   wanted hand position (HO-2)
///   f_t = M x'' + B x' + K x             force for this motion of the felt stick (HO-1)
/// If the stick has the learnt dynamics, the open loop is w_c exp(-j w T_d) / (j w) with
/// T_d = T_p + 2 z / w_n.  The subject is a force source (paper section II-B): it perceives other
/// forces on the stick only through the cursor.
/// The force is bounded and slew-limited.  If the subject is inactive or the input is not finite,
/// the force fades to zero within 50 ticks.  An inactive subject restarts from rest.
/// Config, trial number and inputs determine every bit of the output.
/// Source: README Eq. HO-1 to HO-5 and HO-7; paper Eq. 2; McRuer and Jex (1967).
/// Pure; step() never allocates, locks or throws.
class CrossoverOperator {
 public:
  using Config = CrossoverConfig;

  /// @throws stillhand::ConfigError naming the first field that is out of range, and if delay_s is
  ///         less than the lag of the muscle.
  explicit CrossoverOperator(const Config& config);

  /// Begins a new trial; the trial number selects the stream of the remnant.
  void arm(const Trial& trial);

  OperatorOutput step(const OperatorInput& input) noexcept;

  /// Present w_c / 2 pi [Hz].
  [[nodiscard]] double crossover_hz() const noexcept;

 private:
  void start_afresh() noexcept;
  double wanted_force(double error_m, double felt_m_s2) noexcept;

  Config config_;
  double reach_m_;                ///< largest wanted cursor displacement, each side
  std::size_t perception_ticks_;  ///< T_p at rest
  signal::DelayLine delay_;
  signal::RunningRms vibration_m_s2_;
  FastError fast_error_;
  Remnant remnant_;
  signal::SecondOrderLag muscle_;
  signal::ForceEnvelope envelope_;
  double wanted_m_ = 0.0;  ///< u
  double crossover_rad_s_;
  Tick last_tick_ = -1;
  bool rested_ = true;
};

}  // namespace stillhand::human_operator

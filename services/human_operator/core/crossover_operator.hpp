// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/contract/trial.hpp"
#include "services/human_operator/core/crossover_config.hpp"
#include "services/human_operator/core/fast_error.hpp"
#include "services/human_operator/core/operator_io.hpp"
#include "services/human_operator/core/remnant.hpp"
#include "services/signal/delay_line.hpp"
#include "services/signal/force_envelope.hpp"
#include "services/signal/second_order_lag.hpp"

namespace stillhand::human_operator {

/// Simulated subject after McRuer's crossover model, paper Eq. 2, Eq. HO-3:
///
///   u' = w_c (e(t - T_p) + v(t))         wanted cursor, v the remnant (HO-4), w_c from HO-5
///   x  = muscle(u) / 6                   wanted hand position (HO-2)
///   f_t = M x'' + B x' + K x             force that moves the felt stick so (HO-1)
///
/// With a stick that feels as expected the open loop is w_c exp(-j w T_d) / (j w) with
/// T_d = T_p + 2 z / w_n.  The subject is a force source (paper section II-B): whatever else pushes
/// the stick is seen only through the cursor.
/// Force bounded and slew-limited.  It fades to zero within 50 ticks when inactive, and the subject
/// starts afresh; also while the input isn't finite, which the subject doesn't see.  Deterministic:
/// config, trial number and inputs fix every bit.  Pure; step() never allocates, locks or throws.
class CrossoverOperator {
 public:
  using Config = CrossoverConfig;

  /// @throws stillhand::ConfigError naming the first field that is out of range, and when delay_s
  ///         is less than the muscle's lag.
  explicit CrossoverOperator(const Config& config);

  /// A new trial: forgets the last one; the remnant's stream is that of the trial's number.
  void arm(const Trial& trial);

  OperatorOutput step(const OperatorInput& input) noexcept;

  /// w_c / 2 pi in use [Hz].
  [[nodiscard]] double crossover_hz() const noexcept;

 private:
  void start_afresh() noexcept;
  double wanted_force(double error_m) noexcept;

  Config config_;
  double reach_m_;  ///< cursor displacement that the subject ever wants, either side
  signal::DelayLine delay_;
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

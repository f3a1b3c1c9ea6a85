// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "services/core/signal/band_pass.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::cancellation {

/// Compliance through which a motor's force becomes motion, M x'' + B x' + K x = f.
struct SecondaryPath {
  double mass_kg = 1.394;
  double damping_n_s_m = 11.18;
  double stiffness_n_m = 1136.0;
};

struct LmsConfig {
  double step = 0.01;  ///< mu [-] an update
  /// The motor's: the reference passes it (filtered-x).  None: the output is a displacement.
  std::optional<SecondaryPath> path = {};
};

/// Normalised LMS with the platform's acceleration as reference, METHOD Eq. MI-3:
///
///   y(n) = sum_i w_i a(n - 10 i),     u_i = F P a(n - 10 i),     e = F error
///   w_i += mu e u_i / (eps + sum u^2)          every 10 ticks
///
/// F is a band-pass of 0.5 to 6 Hz, in the force form to 3 Hz, P the secondary path or 1.  50
/// weights reach 0.5 s back.  It starts from zero and needs no identification.  The error must be a
/// signal that a rig senses:
/// - signal form (P = 1): y is a displacement [m] taken off the command, error what is left of it;
/// - force form: y is a force [N] that the motor takes away, error the stick's displacement.  A
///   hand whose compliance is more than 90 degrees from P turns the weights the wrong way.  Above 3
///   Hz there are such hands: a reflex lets one resonate there (README, "Limits").
/// What the person wants is part of that error: it is not correlated with the acceleration and
/// averages out, and until then it moves the weights.
/// Source: Widrow and Stearns, Adaptive Signal Processing, 1985.
/// Pure; no call allocates or throws.
class LmsFilter {
 public:
  static constexpr std::size_t kTaps = 50;
  static constexpr std::size_t kSpacing_ticks = 10;

  /// @throws stillhand::ConfigError unless 0 < step <= 1 and the path is damped and stable.
  explicit LmsFilter(const LmsConfig& config);

  /// One tick.  @return y
  double output(double accel_m_s2) noexcept;
  /// After output() of the same tick.  @param learns  false: the weights stay
  void learn(double error_m, bool learns) noexcept;

  [[nodiscard]] const std::array<double, kTaps>& weights() const noexcept { return weights_; }

 private:
  using History = std::array<double, kTaps * kSpacing_ticks>;

  double step_;
  double compliance_m_n_ = 1.0;
  double floor_;  ///< eps
  std::optional<signal::SecondOrderLag> path_;
  signal::BandPass reference_band_;
  signal::BandPass error_band_;
  std::array<double, kTaps> weights_{};
  History accel_{};      ///< ring
  History reference_{};  ///< ring: u
  std::size_t at_ = 0;   ///< place of the newest
};

}  // namespace stillhand::cancellation

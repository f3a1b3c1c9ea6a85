// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/band_pass.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::cancellation {

/// Omega of METHOD Eq. CC-10.  Paper III-C: the platform moves between 0.7 and 2 Hz; the middle in
/// log frequency is 1.2 Hz.
inline constexpr double kMiddle_rad_s = kTwoPi * 1.2;

/// x'/Omega, a derivative below 15 Hz, well above the band.
class Quadrature {
 public:
  double step(double x) noexcept {
    constexpr double kLag_s = 1.0 / (kTwoPi * 15.0);
    slow_ += kControlPeriod_s / (kLag_s + kControlPeriod_s) * (x - slow_);
    return (x - slow_) / (kLag_s * kMiddle_rad_s);
  }
  void reset() noexcept { slow_ = 0.0; }

 private:
  double slow_ = 0.0;
};

/// The hand's motion, and what a force would make of it, METHOD Eq. CC-10:
///   r = F P (f, f'/Omega),  e = F lever theta
/// Pure; step() neither allocates nor throws.
class ExplainedMotion {
 public:
  using Pair = std::array<double, 2>;
  struct Output {
    Pair r;    ///< [m]
    double e;  ///< [m]
  };

  /// @param compliance  P; sound, see check_model()
  explicit ExplainedMotion(const HandCompliance& compliance);

  Output step(double force_n, double theta_rad) noexcept;
  void reset() noexcept;

 private:
  signal::SecondOrderLag lag_;
  double compliance_m_n_;
  double lever_m_;
  signal::BandPass band_r0_;
  signal::BandPass band_x_;
  Quadrature quadrature_;
};

}  // namespace stillhand::cancellation

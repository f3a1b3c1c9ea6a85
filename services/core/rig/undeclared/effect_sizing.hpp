// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "services/core/rig/parts/body_config.hpp"
#include "services/core/rig/parts/chain_effect.hpp"

namespace stillhand::rig {

/// A short pegged identification trial, the reference for the size of an effect.  The motion is
/// noise of 0.7 to 4 Hz (order 4 at each edge) with an RMS of 0.75 g / 3.8, as in the
/// identification of paper III-A.  It lasts 40 s and is always the same.
/// Source: METHOD Eq. RG-12.  Pure.
class PeggedTrial {
 public:
  /// @throws ConfigError if a field is out of range.
  PeggedTrial(const BodyConfig& body, const StickConfig& stick);

  /// Load-cell force with the effect [N], 1 kHz, without the first second.
  [[nodiscard]] std::vector<double> force_n(const ChainEffect& effect) const;
  /// The same force without the effect [N].
  [[nodiscard]] const std::vector<double>& plain_n() const noexcept { return plain_n_; }
  [[nodiscard]] double plain_rms_n() const noexcept { return plain_rms_n_; }
  /// Eq. RG-12: RMS(f_with - f_without) / RMS(f_without).
  [[nodiscard]] double share(const std::vector<double>& with_n) const;
  [[nodiscard]] double share(const ChainEffect& effect) const { return share(force_n(effect)); }
  /// Eq. RG-37: RMS [N] of what no linear model of the motion explains of a force.
  [[nodiscard]] double beyond_linear_n(const std::vector<double>& with_n) const;

 private:
  BodyConfig body_;
  StickConfig stick_;
  std::vector<double> motion_m_s2_;
  std::vector<double> plain_n_;
  double plain_rms_n_;
};

/// The value between `low` and `high` (positive) at which the monotonic share(value) is `wanted`;
/// the nearer end if no value gives it.  Bisection of the logarithm to 1 part in 1000.
double sized(double low, double high, double wanted, const std::function<double(double)>& share);

/// RMS of the feedthrough force while tracking (paper III-C: 0.7 to 2 Hz, 1.6 m/s^2 RMS) [N].
double tracking_force_rms(const BodyConfig& body, const StickConfig& stick);

}  // namespace stillhand::rig

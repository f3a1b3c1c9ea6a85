// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/core/admittance/arm_model.hpp"
#include "services/core/admittance/line_responses.hpp"

namespace stillhand::admittance {

/// Parameters of a physical arm with their uncertainty.
struct ArmFit {
  ArmValues values{};
  ArmValues standard_error{};    ///< in the unit of the value, Eq. AD-14; 0 where it was not fitted
  bool reflex = false;           ///< the data show a reflex, Eq. AD-15; false: its gains are 0
  double reflex_evidence = 0.0;  ///< decrease of chi^2 by the reflex's four parameters, over AD-13
  double misfit = 0.0;           ///< [-] chi^2 over its expectation, Eq. AD-13; 1: structure holds
  std::int64_t degrees = 0;      ///< of freedom of chi^2, real
  double condition = 0.0;        ///< of the Jacobian of the weighted errors, Eq. AD-14
  std::vector<ArmParameter> fitted;
  std::vector<double> correlation;         ///< of the fitted, [i * fitted.size() + j]
  std::vector<ArmParameter> undetermined;  ///< Eq. AD-14
};

/// Mean person of services/core/population with a tracking arm, rounded.  A fit starts from it and
/// from a softer one.
ArmValues mean_arm() noexcept;

/// Fits the arm to admittance, feedthrough to force and feedthrough to position at once, Eqs. AD-12
/// to AD-15, by Levenberg and Marquardt (ceres::TinySolver):
///
///   e_k = Y - 1/Z             force lines, variance C_Y
///   e_k = F/A + Z X/A - H     motion lines, variance C_FF + |Z|^2 C_XX + 2 Re(Z C_XF)
///
/// The second is the arm's own law, F = H A - Z X: whatever the stick below the load cell does,
/// friction included, does not enter.
/// @throws stillhand::ConfigError when the lines are fewer than the parameters, or a variance is
///         not positive.
ArmFit fit_arm(const LineEstimates& lines);

}  // namespace stillhand::admittance

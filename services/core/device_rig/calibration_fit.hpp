// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace stillhand::device_rig {

/// What a sensor gave while a known quantity acted on it.
struct CalibrationStep {
  double known = 0.0;    ///< [N], [m/s^2] or [rad], + right
  double reading = 0.0;  ///< mean, in volts or counts
  double spread = 0.0;   ///< standard deviation of the samples, the same unit
  std::int64_t samples = 0;
};

/// A straight line through the steps, Eq. DR-15.  x: the known quantity; y: the reading.
struct CalibrationFit {
  double zero = 0.0;         ///< y at x = 0
  double sensitivity = 0.0;  ///< dy/dx
  double zero_error = 0.0;   ///< standard error; NaN with two steps
  double sensitivity_error = 0.0;
  double residual = 0.0;         ///< largest |x of the reading - known|, unit of x
  double noise = 0.0;            ///< largest standard deviation of a step, unit of x
  double drift = 0.0;            ///< last step less the first one, which has the same x; unit of x
  double low = 0.0, high = 0.0;  ///< the known quantities reach from here to there
};

/// @throws ConfigError for fewer than three quantities, or quantities to one side of 0 alone
void check_known(std::span<const double> known);

/// Least squares of y = zero + sensitivity x over the steps, each with the same weight.
/// @param steps  the last one repeats the quantity of the first one
/// @throws ConfigError for fewer than three quantities, quantities of one sign alone, a reading
/// that
///         is not finite, or readings that do not change
CalibrationFit calibration_fit(std::span<const CalibrationStep> steps);

/// What makes a fit useless, in words for the person at the rig; empty: it can be used.  DR-15:
/// residual and drift at most `most_share` of the largest quantity, the sign, and an answer above
/// the sensor's own noise.
/// @param unit  of x
std::string calibration_fault(const CalibrationFit& fit, double most_share, std::string_view unit);

}  // namespace stillhand::device_rig

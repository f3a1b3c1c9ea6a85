// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/calibration_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "services/core/contract/config_error.hpp"

namespace stillhand::device_rig {
namespace {

void check(std::span<const CalibrationStep> steps) {
  std::vector<double> known;
  for (const CalibrationStep& step : steps) {
    if (!std::isfinite(step.reading)) {
      throw ConfigError("calibration step", "a reading that is no number",
                        "a sensor that measures");
    }
    known.push_back(step.known);
  }
  check_known(known);
}

}  // namespace

void check_known(std::span<const double> known) {
  const std::set<double> different(known.begin(), known.end());
  if (different.size() < 3 || *different.begin() >= 0.0 || *different.rbegin() <= 0.0) {
    throw ConfigError("known quantities", fmt::format("{} different ones", different.size()),
                      "three or more, to both sides of 0");
  }
}

CalibrationFit calibration_fit(std::span<const CalibrationStep> steps) {
  check(steps);
  const auto count = static_cast<double>(steps.size());
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (const CalibrationStep& step : steps) {
    mean_x += step.known / count;
    mean_y += step.reading / count;
  }
  double s_xx = 0.0;
  double s_xy = 0.0;
  for (const CalibrationStep& step : steps) {
    s_xx += (step.known - mean_x) * (step.known - mean_x);
    s_xy += (step.known - mean_x) * (step.reading - mean_y);
  }
  CalibrationFit fit;
  fit.sensitivity = s_xy / s_xx;
  if (fit.sensitivity == 0.0) {
    throw ConfigError("readings", "the same one at every step", "a sensor that answers");
  }
  fit.zero = mean_y - fit.sensitivity * mean_x;
  double squares = 0.0;
  for (const CalibrationStep& step : steps) {
    const double off = step.reading - fit.zero - fit.sensitivity * step.known;
    squares += off * off;
    fit.residual = std::max(fit.residual, std::abs(off / fit.sensitivity));
    fit.noise = std::max(fit.noise, std::abs(step.spread / fit.sensitivity));
    fit.low = std::min(fit.low, step.known);  // 0 lies between
    fit.high = std::max(fit.high, step.known);
  }
  const double variance = squares / (count - 2.0);
  fit.sensitivity_error = std::sqrt(variance / s_xx);
  fit.zero_error = std::sqrt(variance * (1.0 / count + mean_x * mean_x / s_xx));
  fit.drift = (steps.back().reading - steps.front().reading) / fit.sensitivity;
  return fit;
}

std::string calibration_fault(const CalibrationFit& fit, double most_share, std::string_view unit) {
  const double largest = std::max(-fit.low, fit.high);
  const double most = most_share * largest;
  // First: of such a line, sign, drift and residual mean nothing.
  if (fit.noise >= largest) {
    return fmt::format(
        "the sensor does not react: {:.3g} {} change the reading by no more than its noise; look "
        "at its cable, its supply, and the input in devices.yaml",
        largest, unit);
  }
  if (fit.sensitivity < 0.0) {
    return "the reading falls where it must grow (positive is to the right): turn the sensor or "
           "change its sign in devices.yaml, and calibrate again";
  }
  if (std::abs(fit.drift) > most) {
    return fmt::format(
        "the first quantity, applied again, reads {:.3g} {} away from the first time, more than "
        "{:.3g} {}: something slipped or warms up",
        fit.drift, unit, most, unit);
  }
  if (fit.residual > most) {
    return fmt::format(
        "a step is {:.3g} {} off the straight line, more than {:.3g} {}: a wrong quantity at one "
        "step, a loose mount, or a sensor at its end",
        fit.residual, unit, most, unit);
  }
  return {};
}

}  // namespace stillhand::device_rig

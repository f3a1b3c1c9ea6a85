// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/study/explain/explain.hpp"

namespace stillhand::study {

/// One step of a calibration.
struct CalibrationStep {
  std::vector<double> shift;  ///< logarithm of each calibrated mean over its start
  TableVector z;              ///< (simulated - paper) / the paper's standard error
  double cost = 0.0;          ///< of Eq. SU-6
};

/// A calibrated population and how it came about.
struct Calibration {
  population::Population population;
  std::vector<CalibrationStep> steps;  ///< the start first
  TableVector judged_z;                ///< on the subjects of seed + 1
  std::size_t subjects = 0;
  std::uint64_t seed = 0;
};

/// Moves the calibrated means (causes.hpp) so that conditions A and B meet the paper's Table I,
/// METHOD Eq. SU-6.  C is not looked at.
/// @throws ConfigError for options out of range; Interrupted
Calibration calibrate(const ExplainOptions& options, const OnStage& on_stage);

/// The population as a file for --population, with the log of the calibration in its comments.
std::string population_yaml(const Calibration& calibration, const std::string& command_line);

/// The log, on standard output.
void print_calibration(const Calibration& calibration);

}  // namespace stillhand::study

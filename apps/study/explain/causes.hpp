// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/study/subjects/subject_session.hpp"

namespace stillhand::study {

/// A candidate cause of what the model lacks, with at most one parameter; README, "What explains
/// the paper's C".
struct Cause {
  std::string name;            ///< in explanation.json
  std::string what;            ///< one sentence
  std::string source;          ///< literature of its range, or that there is none
  std::string parameter = {};  ///< with its unit; empty: no parameter
  double none = 0.0;           ///< value of the parameter without the cause
  /// Values that are simulated, ascending.  A person's value that is drawn beyond them counts as
  /// the nearest.
  std::vector<double> grid = {};
  double most = 0.0;      ///< the prior is uniform from the first value of the grid to this
  bool personal = false;  ///< the parameter may differ between subjects, Eq. SU-1
  std::function<void(StudyOptions&, double value)> apply = {};
  /// The same with a spread between subjects; for personal ones.
  std::function<void(population::Population&, double cv)> spread = {};
};

/// Every cause; the paper's chain first.
const std::vector<Cause>& causes();

/// [s] Lateness of the paper's chain, METHOD of cancellation CC-16.
inline constexpr double kPaperChain_s = 0.0815;

/// What could make people differ in C, with the paper's chain; METHOD Eq. SU-23.  The prior is the
/// whole grid.
const std::vector<Cause>& spread_causes();

/// A mean of the population that is calibrated; its logarithm has a normal prior about the
/// default, METHOD SU-6.
struct Calibrated {
  std::string name;
  double prior_sd;  ///< of the logarithm [-]
  std::string source;
  std::function<void(population::Population&, double factor)> scale;
};

/// The calibrated means, and the spread of every quantity.
const std::vector<Calibrated>& calibrated();

/// The population with the logarithm of each calibrated mean moved by `shift`, in their order;
/// values stay inside their ranges.
population::Population shifted(population::Population population, const std::vector<double>& shift);

}  // namespace stillhand::study

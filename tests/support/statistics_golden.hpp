// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "places.hpp"
#include "tests/golden/statistics/expected.hpp"

namespace stillhand::support {

/// One of the three generated sets of trials of tests/golden/statistics; rows in the order
/// row = (subject * conditions + condition) * replicates + replicate, from 0.
struct Trials {
  Eigen::Index subjects, conditions, replicates;
  Eigen::MatrixXd values;  ///< [n_trials x n_metrics]

  /// The first of each, as the golden results were computed.
  Eigen::MatrixXd part(Eigen::Index subjects_wanted, Eigen::Index conditions_wanted,
                       Eigen::Index replicates_wanted, Eigen::Index metrics_wanted) const {
    Eigen::MatrixXd out(subjects_wanted * conditions_wanted * replicates_wanted, metrics_wanted);
    Eigen::Index row = 0;
    for (Eigen::Index s = 0; s < subjects_wanted; ++s) {
      for (Eigen::Index c = 0; c < conditions_wanted; ++c) {
        const Eigen::Index first = (s * conditions + c) * replicates;
        out.middleRows(row, replicates_wanted) =
            values.block(first, 0, replicates_wanted, metrics_wanted);
        row += replicates_wanted;
      }
    }
    return out;
  }

  /// First replicate of every subject under one condition.
  std::vector<double> under(int condition, int metric) const {
    std::vector<double> out;
    for (Eigen::Index s = 0; s < subjects; ++s) {
      out.push_back(values((s * conditions + condition) * replicates, metric));
    }
    return out;
  }

  std::vector<double> all(int metric) const {
    const Eigen::VectorXd column = values.col(metric);
    return {column.begin(), column.end()};
  }
};

/// 0 well behaved, 1 strong effects, 2 replicated.
inline Trials golden_trials(int set) {
  struct Form {
    const char* file;
    Eigen::Index subjects, conditions, replicates, metrics;
  };
  static constexpr Form kForms[] = {
      {"well_behaved", 12, 3, 1, 3}, {"strong_effects", 20, 3, 1, 3}, {"replicated", 9, 6, 3, 5}};
  const Form& form = kForms[set];
  Trials out{form.subjects, form.conditions, form.replicates, {}};
  out.values.resize(form.subjects * form.conditions * form.replicates, form.metrics);
  std::ifstream file(std::string(STILLHAND_SOURCE "/tests/golden/statistics/") + form.file +
                     ".csv");
  std::string cell;
  std::getline(file, cell);  // titles
  for (auto row : out.values.rowwise()) {
    for (int i = 0; i < 3; ++i) std::getline(file, cell, ',');  // subject, condition, replicate
    for (Eigen::Index i = 0; i < form.metrics; ++i) {
      std::getline(file, cell, i + 1 < form.metrics ? ',' : '\n');
      row(i) = std::stod(cell);
    }
  }
  return out;
}

/// Equal to 1e-9 of the expected value: what the results are asked to be good for.  Rounding of
/// both sides stays below (1e-16 times a few hundred operations and a condition of at most 1e4);
/// a wrong formula doesn't.
inline ::testing::AssertionResult agrees(double got, double expected) {
  const double error = std::abs(got - expected);
  if (error <= 1e-9 * std::abs(expected)) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure()
         << "got " << got << ", expected " << expected << ", off by " << error / std::abs(expected);
}

}  // namespace stillhand::support

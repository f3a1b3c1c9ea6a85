// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/diagnosis/core/model/effect_kind.hpp"
#include "services/diagnosis/core/model/evaluation.hpp"

namespace stillhand::diagnosis {

/// A free run with what its derivatives are made of.
struct ModelRun {
  FreeRun free;
  std::vector<double> gain;           ///< on the body's output
  std::vector<Columns> term_columns;  ///< by effect, as weighed: through A where the form says so
  std::vector<double> through_body;   ///< sum of the terms that passed A
  bool passes_terms = false;          ///< any did
  Columns filtered_inputs;            ///< u_k / A; none with feedback
  Columns inputs;                     ///< u_k as they reach the body; with feedback alone
};

/// Runs a model over its signals, README "The model".
void run_all(const Model& model, const Signals& signals, ModelRun& run);

/// Weighted output - prediction.
Eigen::VectorXd weighted_error(const FreeRun& run, const Signals& signals);

bool acts_at(const Effect& effect, Stage stage);

}  // namespace stillhand::diagnosis

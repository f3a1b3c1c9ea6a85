// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/steady_start.hpp"

namespace stillhand::diagnosis {

/// A free run with what its derivatives are made of.
struct ModelRun {
  FreeRun free;
  std::vector<double> gain;           ///< on the body's output
  std::vector<Columns> term_columns;  ///< by effect, as weighed: through A where the form says so
  Columns terms;                      ///< by effect, what they add to the prediction
  Settled through_body;               ///< sum of the terms that passed A
  bool passes_terms = false;          ///< any did
  std::vector<Settled> filtered_inputs;  ///< u_k / A; none with feedback
  std::vector<Settled> inputs;           ///< u_k as they reach the body; with feedback alone
  std::vector<double> body_before;       ///< [stretches] level of y_b before each
  std::vector<double> phi_before;        ///< [stretches] of phi(z); with feedback alone
};

/// A run of a model from which others differ in one number each: what the number does not change is
/// taken from it.  The others' `terms` and what derivatives are made of stay empty.
struct KnownRun {
  const ModelRun& run;
  std::vector<std::optional<std::size_t>> owners;  ///< [models] whose number; none: the body's
};

/// Runs a model over its signals, METHOD "The model".
void run_all(const Model& model, const Signals& signals, ModelRun& run);
/// The same for models that differ in their numbers alone.
void run_all(std::span<const Model> models, const Signals& signals, std::span<ModelRun> runs,
             const KnownRun* known = nullptr);

/// A model's run and its residual: what its columns at the same numbers are made of.
struct Evaluation {
  ModelRun run;
  Eigen::VectorXd residual;              ///< as in Linearisation; not finite: output - prediction
  std::optional<InitialStates> initial;  ///< none if the run is not finite
};

Evaluation evaluated(const Model& model, const Signals& signals);

/// The columns of Linearisation.
/// @param at  of the same model, finite
Eigen::MatrixXd jacobian_of(const Model& model, const Signals& signals, const Evaluation& at);

}  // namespace stillhand::diagnosis

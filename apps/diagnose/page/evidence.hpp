// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/diagnosis/fitting/number_errors.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/signals.hpp"
#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::diagnose {

/// A model's free run over the record, and what it leaves.
struct ModelRun {
  diagnosis::FreeRun run;
  std::vector<double> residual;  ///< weighted, initial states taken out; see residual_of()
};

/// What the page shows of a diagnosis: its models, run again on the samples that the engine used.
struct Evidence {
  /// @param verdict  must stay as long as this
  /// @throws as diagnosis::Signals
  Evidence(const diagnosis::Diagnosis& verdict, const diagnosis::Measurement& measurement);

  const diagnosis::Diagnosis& found;
  diagnosis::Measurement working;
  diagnosis::Signals signals;
  ModelRun before;                 ///< of the baseline
  diagnosis::Linearisation line;   ///< of the baseline with the effects
  ModelRun after;                  ///< likewise
  diagnosis::NumberErrors errors;  ///< of its numbers
  double correlation_samples;      ///< [samples] of the residual: 1 + 2 sum of its correlations
};

/// The part of the prediction that one effect of the final model makes.
struct EffectTrace {
  diagnosis::FreeRun run;            ///< of the model without it
  std::vector<double> without;       ///< residual of the model without it
  std::vector<double> contribution;  ///< what it takes away: `without` less the final residual
  /// The rest of the model was fitted again without it, because it cannot be taken out of a loop;
  /// otherwise the other numbers are those of the joint fit.
  bool refitted = false;
};

/// @param which  index in found.model.effects
EffectTrace trace_of(const Evidence& evidence, std::size_t which);

}  // namespace stillhand::diagnose

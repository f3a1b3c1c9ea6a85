// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/evidence.hpp"

#include <Eigen/Dense>

#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Diagnosis;
using diagnosis::Effect;
using diagnosis::Model;
using diagnosis::Stage;

std::vector<double> plain(const Eigen::VectorXd& x) { return {x.data(), x.data() + x.size()}; }

ModelRun run_of(const Model& model, const diagnosis::Signals& signals) {
  ModelRun result;
  result.residual = plain(diagnosis::residual_of(model, signals, result.run));
  return result;
}

}  // namespace

Evidence::Evidence(const Diagnosis& verdict, const diagnosis::Measurement& measurement)
    : found(verdict),
      working(diagnosis::working_set(measurement, found.options.inputs)),
      signals(working, found.options.inputs, found.options.output),
      before(run_of(found.baseline.model, signals)),
      line(diagnosis::linearised(found.model, signals)),
      after{line.run, plain(line.residual)},
      errors(found.model, line, signals),
      correlation_samples(diagnosis::correlation_samples(line.residual, signals.rate_hz())) {}

EffectTrace trace_of(const Evidence& evidence, std::size_t which) {
  Model model = evidence.found.model;
  const Effect effect = model.effects.at(which);
  model.effects.erase(model.effects.begin() + static_cast<std::ptrdiff_t>(which));
  EffectTrace trace;
  if (diagnosis::acts_at(effect, Stage::kFeedback)) {
    trace.refitted = true;
    model.body = evidence.found.baseline.model.body;
    diagnosis::fit(model, evidence.signals, diagnosis::make_blocks(evidence.signals));
  }
  const bool weighs = diagnosis::acts_at(effect, Stage::kWeight);
  if (trace.refitted || weighs) {
    ModelRun without = run_of(model, evidence.signals);
    trace.run = std::move(without.run);
    trace.without = std::move(without.residual);
  } else {
    trace.run = diagnosis::free_run(model, evidence.signals);
    trace.without = evidence.after.residual;
    for (std::size_t n = 0; n < trace.without.size(); ++n) {
      trace.without[n] += evidence.after.run.weight[n] *
                          (evidence.after.run.prediction[n] - trace.run.prediction[n]);
    }
  }
  trace.contribution = trace.without;
  for (std::size_t n = 0; n < trace.contribution.size(); ++n) {
    trace.contribution[n] -= evidence.after.residual[n];
  }
  return trace;
}

}  // namespace stillhand::diagnose

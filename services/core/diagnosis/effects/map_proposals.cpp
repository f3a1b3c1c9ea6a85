// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/effects/map_proposals.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kNewBodies = 3;  // values of a map that get one

// The inputs as they reach the body behind a map of the first.
std::vector<std::vector<double>> mapped_inputs(const Screening& screening, const Effect& map) {
  std::vector<std::vector<double>> inputs = measured_inputs(screening);
  const EffectKind& kind = effect_kind(map.kind);
  for (double& u : inputs.front()) u = kind.mapped(map, u);
  return inputs;
}

// The proposal whose free run with a body of its own leaves least.  The body that was fitted
// without the effect may be in a local minimum that no step with the effect leaves.  Without a body
// where none is finite, the body is static or the model has other effects.
Proposal best_with_body(const Screening& screening, std::vector<Proposal> proposals,
                        const std::function<Body(const Effect&)>& body_for) {
  Proposal best;
  if (!screening.model().effects.empty() || screening.model().body.order() == 0) return best;
  for (const Proposal& known : screening.known(proposals.front().effect.kind)) {
    if (known.effect.form == proposals.front().effect.form) return known;
  }
  for (Proposal& each : proposals) {
    each = with_body(screening, each.effect, body_for(each.effect));
    if (std::isfinite(each.gain) && (!best.body || each.gain > best.gain)) best = std::move(each);
  }
  return best;
}

// What the map with this value adds to a signal.
std::vector<double> changed(std::vector<double> signal, const Map& difference, double value) {
  for (double& each : signal) each = difference(each, value);
  return signal;
}

// The value whose column gains most, and the one that does with a body of its own.
std::vector<Proposal> tried(const Screening& screening, const Effect& effect,
                            const std::vector<double>& values,
                            const std::function<std::vector<double>(double value)>& column,
                            const std::function<Body(const Effect&)>& body_for) {
  std::vector<Proposal> proposals;
  for (const double value : values) {
    const ScreenedGain gain = screening.gain({column(value)});
    Proposal proposal{effect, gain.share, {}};
    proposal.effect.parameters.front().value = value;
    proposals.push_back(std::move(proposal));
  }
  std::vector<Proposal> all = best_of(proposals, 1);
  if (Proposal best =
          best_with_body(screening, best_of(std::move(proposals), kNewBodies), body_for);
      best.body) {
    all.push_back(std::move(best));
  }
  return all;
}

}  // namespace

std::vector<std::vector<double>> measured_inputs(const Screening& screening) {
  std::vector<std::vector<double>> inputs;
  for (const Signal& input : screening.signals().inputs()) inputs.push_back(input.values);
  return inputs;
}

Body new_body(const Screening& screening, const std::vector<std::vector<double>>& inputs,
              const std::vector<double>& output, std::optional<int> of_order) {
  const Signals& signals = screening.signals();
  const int order = of_order.value_or(static_cast<int>(screening.model().body.order()));
  Body body = started_body(inputs, output, {}, signals, order);
  if (order == 4) body = with_other_mode(body, inputs, output, signals);
  if (is_stable(body)) return body;
  stabilise(body);
  return refined_body(body, inputs, output, signals);
}

Proposal with_body(const Screening& screening, const Effect& effect, Body body) {
  Model model = screening.model();
  model.body = body;
  model.effects.push_back(effect);
  FreeRun run;
  const double square = residual_of(model, screening.signals(), run).squaredNorm();
  const double gain = 1.0 - square / screening.residual().squaredNorm();
  return {effect, run.finite ? gain : -HUGE_VAL, std::move(body)};
}

std::vector<Proposal> input_map_proposals(const Screening& screening, const Effect& effect,
                                          const std::vector<double>& values,
                                          const Map& difference) {
  const auto column = [&](double value) {
    const std::vector<double>& u = screening.signals().inputs().front().values;
    return response_of(screening, changed(u, difference, value));
  };
  const auto body_for = [&](const Effect& effect_tried) {
    return new_body(screening, mapped_inputs(screening, effect_tried),
                    screening.signals().output().values);
  };
  return tried(screening, effect, values, column, body_for);
}

std::vector<Proposal> output_map_proposals(const Screening& screening, const Effect& effect,
                                           const std::vector<double>& values, const Map& difference,
                                           const Map& before) {
  const auto column = [&](double value) {
    return changed(screening.prediction(), difference, value);
  };
  const auto body_for = [&](const Effect& effect_tried) {
    std::vector<double> unmapped = screening.signals().output().values;
    for (double& each : unmapped) each = before(each, effect_tried.value(0));
    return new_body(screening, measured_inputs(screening), unmapped);
  };
  return tried(screening, effect, values, column, body_for);
}

}  // namespace stillhand::diagnosis

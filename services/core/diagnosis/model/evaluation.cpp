// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/evaluation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/interpolation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model_run.hpp"

namespace stillhand::diagnosis {
namespace {

// A map goes on straight where it was not seen, at most as steep as no map at all, Eq. DG-56.
double mapped_within(const EffectKind& kind, const Effect& effect, double value) {
  if (effect.seen.empty()) return mapped_in_part(kind, effect, value);
  constexpr double kStep = 1e-6;  // of the way from the middle to the edge
  const SeenRange& range = effect.seen.front();
  const double edge = range.held(value);
  const double inside = mapped_in_part(kind, effect, edge);
  if (edge == value) return inside;
  const double step = kStep * (edge - 0.5 * (range.low + range.high));
  if (step == 0.0) return inside;
  const double slope = (inside - mapped_in_part(kind, effect, edge - step)) / step;
  return inside + std::clamp(slope, -1.0, 1.0) * (value - edge);
}

std::vector<double> shaped_input(const Model& model, const Signals& signals, std::size_t k) {
  std::vector<double> u = signals.inputs()[k].values;
  for (const Effect& effect : model.effects) {
    if (!acts_at(effect, Stage::kInputTime)) continue;
    u = delayed(u, signals, [&](double t_s) { return delay_in_part(effect, t_s); });
  }
  for (const Effect& effect : model.effects) {
    if (!acts_at(effect, Stage::kInputValue) || effect.channels.at(0) != model.inputs[k]) continue;
    const EffectKind& kind = effect_kind(effect.kind);
    for (double& value : u) value = mapped_within(kind, effect, value);
  }
  return u;
}

// From rest at 0.
Settled rested(std::vector<double> x, const Signals& signals) {
  return {std::move(x), std::vector<double>(signals.stretches().size(), 0.0)};
}

Settled nothing(const Signals& signals) {
  return rested(std::vector<double>(signals.size(), 0.0), signals);
}

// What reaches the body: settled, or, where the state is known, from 0.
Settled reaching(const Model& model, const Signals& signals, std::size_t k) {
  std::vector<double> u = shaped_input(model, signals, k);
  return signals.start().empty() ? settled(std::move(u), signals) : rested(std::move(u), signals);
}

void add_scaled(const std::vector<double>& x, double factor, std::vector<double>& sum) {
  for (std::size_t n = 0; n < x.size(); ++n) sum[n] += factor * x[n];
}

// sum_i c_i D^i x
void add_differences(Settled x, std::span<const double> coefficients,
                     const std::vector<Stretch>& stretches, Settled& sum) {
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (i > 0) x = differenced(x, stretches);
    add_scaled(x, coefficients[i], sum);
  }
}

void run_linear_body(const Model& model, const Signals& signals, ModelRun& run) {
  Settled body = nothing(signals);
  for (std::size_t k = 0; k < model.inputs.size(); ++k) {
    run.filtered_inputs.push_back(
        through_poles(reaching(model, signals, k), model.body.denominator, signals.stretches()));
    add_differences(run.filtered_inputs.back(), difference_basis(model.body.numerators[k]),
                    signals.stretches(), body);
  }
  if (!signals.start().empty()) {
    add_scaled(through_poles(signals.start().front(), model.body.denominator, signals.stretches()),
               1.0, body.values);
  }
  run.free.body = std::move(body.values);
  run.body_before = std::move(body.before);
}

// A start state is one input more, which acts on the output as it is.
Body with_start(Body body) {
  body.numerators.emplace_back(body.order() + 1, 0.0);
  body.numerators.back().front() = 1.0;
  return body;
}

// With a start state as one input more.
std::vector<Settled> reaching_all(const Model& model, const Signals& signals) {
  std::vector<Settled> inputs;
  for (std::size_t k = 0; k < model.inputs.size(); ++k) {
    inputs.push_back(reaching(model, signals, k));
  }
  if (!signals.start().empty()) inputs.push_back(rested(signals.start().front(), signals));
  return inputs;
}

// Whose number changes what reaches the body.
bool is_before_body(const Model& model, std::size_t effect) {
  const Effect& each = model.effects[effect];
  return acts_at(each, Stage::kInputTime) || acts_at(each, Stage::kInputValue);
}

// Whose number changes what comes behind the body, not the body's output.
bool is_behind_body(const Effect& effect) {
  const Stage stage = effect_kind(effect.kind).stage(effect);
  return stage == Stage::kTerm || stage == Stage::kGain || stage == Stage::kOutputValue;
}

// @param known  or nullptr
void run_bodies(std::span<const Model> models, const Signals& signals, std::span<ModelRun> runs,
                const KnownRun* known) {
  std::vector<LoopCase> cases;
  std::vector<Body> started(signals.start().empty() ? 0 : models.size());
  std::vector<std::size_t> with_loop;
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (known != nullptr && known->owners[i] &&
        is_behind_body(models[i].effects[*known->owners[i]])) {
      runs[i].free.body = known->run.free.body;
      continue;
    }
    LoopCase each{&models[i].body, feedback_of(models[i]), &runs[i].inputs};
    if (each.feedback == nullptr) {
      run_linear_body(models[i], signals, runs[i]);
      continue;
    }
    if (known != nullptr && !(known->owners[i] && is_before_body(models[i], *known->owners[i]))) {
      each.inputs = &known->run.inputs;
    } else {
      runs[i].inputs = reaching_all(models[i], signals);
    }
    if (!started.empty()) {
      started[i] = with_start(models[i].body);
      each.body = &started[i];
    }
    cases.push_back(each);
    with_loop.push_back(i);
  }
  std::vector<LoopRun> loops(cases.size());
  run_loops(cases, signals, loops);
  for (std::size_t i = 0; i < loops.size(); ++i) {
    ModelRun& run = runs[with_loop[i]];
    run.free.finite = loops[i].finite;
    run.free.body = std::move(loops[i].output);
    run.free.argument = std::move(loops[i].argument);
    run.free.phi = std::move(loops[i].phi);
    run.body_before = std::move(loops[i].output_before);
    run.phi_before = std::move(loops[i].phi_before);
  }
}

// The columns of a term as they are weighed: through A where the form says so.
void weigh_columns(const Model& model, const Signals& signals, const Columns& columns,
                   std::size_t e, ModelRun& run) {
  const Effect& effect = model.effects[e];
  std::size_t next = 0;
  for (const auto& each : columns) {
    if (!effect_kind(effect.kind).through_body(effect)) {
      add_scaled(each, effect.share * effect.coefficients.at(next++), run.terms[e]);
      run.term_columns[e].push_back(each);
      continue;
    }
    run.passes_terms = true;
    Settled column =
        through_poles(settled(each, signals), model.body.denominator, signals.stretches());
    for (std::size_t i = 0; i <= model.body.order(); ++i) {
      if (i > 0) column = differenced(column, signals.stretches());
      const double weight = effect.share * effect.coefficients.at(next++);
      add_scaled(column.values, weight, run.terms[e]);
      add_scaled(column, weight, run.through_body);
      run.term_columns[e].push_back(column.values);
    }
  }
}

// @param known  or nullptr
// @param owner  of the number that differs there
void add_terms(const Model& model, const Signals& signals, const ModelRun* known,
               std::optional<std::size_t> owner, ModelRun& run) {
  run.term_columns.resize(model.effects.size());
  run.terms.resize(model.effects.size());
  run.through_body = nothing(signals);
  for (std::size_t e = 0; e < model.effects.size(); ++e) {
    const Effect& effect = model.effects[e];
    const EffectKind& kind = effect_kind(effect.kind);
    if (kind.stage(effect) != Stage::kTerm) continue;
    if (known != nullptr && (owner ? *owner != e : !kind.through_body(effect))) {
      add_scaled(known->terms[e], 1.0, run.free.prediction);
      continue;
    }
    Columns columns;
    if (effect.seen.empty()) {
      kind.terms(effect, signals, run.free.body, columns);
    } else {
      kind.terms(effect, signals.within(effect.seen), run.free.body, columns);
    }
    run.terms[e].assign(signals.size(), 0.0);
    weigh_columns(model, signals, columns, e, run);
    if (!signals.start().empty() && !signals.start()[e + 1].empty()) {
      add_scaled(through_poles(signals.start()[e + 1], kind.own_poles(effect, signals.rate_hz()),
                               signals.stretches()),
                 1.0, run.terms[e]);
    }
    add_scaled(run.terms[e], 1.0, run.free.prediction);
  }
}

void apply_gain(const Model& model, const Signals& signals, ModelRun& run) {
  run.gain.assign(signals.size(), 1.0);
  for (const Effect& effect : model.effects) {
    if (!acts_at(effect, Stage::kGain)) continue;
    if (effect.seen.empty()) {
      gain_in_part(effect, signals, run.gain);
    } else {
      gain_in_part(effect, signals.within(effect.seen), run.gain);
    }
  }
  run.free.prediction.resize(signals.size());
  for (std::size_t n = 0; n < signals.size(); ++n) {
    run.free.prediction[n] = model.body.offset + run.gain[n] * run.free.body[n];
  }
}

void apply_output_maps(const Model& model, const Signals& signals, ModelRun& run) {
  run.free.output_slope.assign(signals.size(), 1.0);
  run.free.weight = signals.weight();
  for (const Effect& effect : model.effects) {
    const EffectKind& kind = effect_kind(effect.kind);
    const Stage stage = kind.stage(effect);
    if (stage == Stage::kWeight) kind.weigh(effect, signals, run.free.weight);
    if (stage != Stage::kOutputValue) continue;
    if (!effect.seen.empty()) run.free.unmapped.push_back(run.free.prediction);
    for (std::size_t n = 0; n < signals.size(); ++n) {
      run.free.output_slope[n] *= slope_in_part(kind, effect, run.free.prediction[n]);
      run.free.prediction[n] = mapped_within(kind, effect, run.free.prediction[n]);
    }
  }
}

}  // namespace

double runaway_bound(const Signal& output) {
  constexpr double kRunaway = 1e6;
  constexpr double kOfNothing = 1e30;
  const double size = output.deviation + std::abs(output.mean);
  return size > 0.0 ? kRunaway * size : kOfNothing;
}

void run_all(const Model& model, const Signals& signals, ModelRun& run) {
  run_all(std::span(&model, 1), signals, std::span(&run, 1));
}

void run_all(std::span<const Model> models, const Signals& signals, std::span<ModelRun> runs,
             const KnownRun* known) {
  run_bodies(models, signals, runs, known);
  const double bound = runaway_bound(signals.output());
  for (std::size_t i = 0; i < models.size(); ++i) {
    ModelRun& run = runs[i];
    apply_gain(models[i], signals, run);
    if (known == nullptr) {
      add_terms(models[i], signals, nullptr, {}, run);
    } else {
      add_terms(models[i], signals, &known->run, known->owners[i], run);
    }
    apply_output_maps(models[i], signals, run);
    run.free.finite =
        run.free.finite && is_stable(models[i].body) &&
        std::ranges::all_of(run.free.prediction, [&](double y) { return std::abs(y) < bound; });
  }
}

namespace {

using Filter = void (*)(std::span<const double> x, const std::vector<double>& denominator,
                        double* y);

// The newest sample comes last in the sum: the next one waits for that product alone.
template <std::size_t P>
void filter(std::span<const double> x, const std::vector<double>& denominator, double* y) {
  std::array<double, P> past{};
  for (std::size_t n = 0; n < x.size(); ++n) {
    double sum = x[n];
#pragma GCC unroll 8
    for (std::size_t j = P; j >= 1; --j) sum -= denominator[j] * past[j - 1];
#pragma GCC unroll 8
    for (std::size_t j = P; j >= 2; --j) past[j - 1] = past[j - 2];
    y[n] = past[0] = sum;
  }
}

void filter_of_any_order(std::span<const double> x, const std::vector<double>& denominator,
                         double* y) {
  for (std::size_t n = 0; n < x.size(); ++n) {
    double sum = x[n];
    for (std::size_t j = std::min(denominator.size() - 1, n); j >= 1; --j) {
      sum -= denominator[j] * y[n - j];
    }
    y[n] = sum;
  }
}

Filter filter_of(std::size_t order) {
  constexpr std::array<Filter, 7> kOfOrder{nullptr,   nullptr, filter<2>, filter<3>,
                                           filter<4>, nullptr, filter<6>};
  const Filter own = order < kOfOrder.size() ? kOfOrder[order] : nullptr;
  return own != nullptr ? own : filter_of_any_order;
}

}  // namespace

std::vector<double> through_poles(const std::vector<double>& x,
                                  const std::vector<double>& denominator,
                                  const std::vector<Stretch>& stretches) {
  const std::size_t order = denominator.size() - 1;
  if (order == 0) return x;
  std::vector<double> y(x.size());
  for (const Stretch& stretch : stretches) {
    filter_of(order)(std::span(x).subspan(stretch.first, stretch.end - stretch.first), denominator,
                     y.data() + stretch.first);
  }
  return y;
}

std::vector<double> through_path(const std::vector<double>& x, std::span<const double> numerator,
                                 const std::vector<double>& denominator,
                                 const std::vector<Stretch>& stretches) {
  const std::vector<double> filtered = through_poles(x, denominator, stretches);
  std::vector<double> y(x.size(), 0.0);
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      for (std::size_t i = 0; i < numerator.size() && i <= n - stretch.first; ++i) {
        y[n] += numerator[i] * filtered[n - i];
      }
    }
  }
  return y;
}

std::vector<double> differenced(const std::vector<double>& x,
                                const std::vector<Stretch>& stretches) {
  std::vector<double> result(x.size());
  for (const Stretch& stretch : stretches) {
    double before = 0.0;
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      result[n] = x[n] - before;
      before = x[n];
    }
  }
  return result;
}

std::vector<double> lagged(const std::vector<double>& x, std::size_t lag,
                           const std::vector<Stretch>& stretches) {
  std::vector<double> y(x.size());
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      y[n] = x[n - stretch.first >= lag ? n - lag : stretch.first];
    }
  }
  return y;
}

FreeRun free_run(const Model& model, const Signals& signals, bool with_time_only) {
  ModelRun run;
  if (with_time_only) {
    run_all(model, signals, run);
    return std::move(run.free);
  }
  Model determined = model;
  std::erase_if(determined.effects,
                [](const Effect& effect) { return effect_kind(effect.kind).time_only(effect); });
  run_all(determined, signals, run);
  return std::move(run.free);
}

bool without_effects(const Model& model, const Signals& signals,
                     std::vector<std::vector<double>>& inputs, std::vector<double>& output) {
  for (const Effect& effect : model.effects) {
    if (acts_at(effect, Stage::kFeedback) || acts_at(effect, Stage::kOutputValue)) return false;
  }
  inputs.clear();
  for (std::size_t k = 0; k < model.inputs.size(); ++k) {
    inputs.push_back(shaped_input(model, signals, k));
  }
  ModelRun run;
  run_all(model, signals, run);
  constexpr double kSmallestGain = 0.05;
  for (std::size_t n = 0; n < output.size(); ++n) {
    const double gain = std::max(run.gain[n], kSmallestGain);
    const double terms =
        run.free.prediction[n] - model.body.offset - run.gain[n] * run.free.body[n];
    output[n] = (output[n] - terms) / gain;
  }
  return true;
}

namespace {

Eigen::VectorXd weighted_error(const FreeRun& run, const Signals& signals) {
  Eigen::VectorXd residual(static_cast<Eigen::Index>(signals.size()));
  const auto& measured = signals.output().values;
  for (std::size_t n = 0; n < signals.size(); ++n) {
    residual[static_cast<Eigen::Index>(n)] = run.weight[n] * (measured[n] - run.prediction[n]);
  }
  return residual;
}

}  // namespace

Evaluation evaluated(const Model& model, const Signals& signals) {
  Evaluation result;
  run_all(model, signals, result.run);
  const FreeRun& run = result.run.free;
  result.residual = weighted_error(run, signals);
  if (!run.finite) return result;
  result.initial.emplace(model, signals, run.weight);
  Eigen::Ref<Eigen::MatrixXd> view(result.residual);
  result.initial->remove_from(view);
  signals.whiten(view, run.weight);
  return result;
}

Eigen::VectorXd residual_of(const Model& model, const Signals& signals, FreeRun& run) {
  Evaluation at = evaluated(model, signals);
  run = std::move(at.run.free);
  return std::move(at.residual);
}

}  // namespace stillhand::diagnosis

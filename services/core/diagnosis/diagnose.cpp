// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/diagnose.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/before_effects.hpp"
#include "services/core/diagnosis/body_order.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/judging.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/parts_out.hpp"
#include "services/core/diagnosis/working_set.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::diagnosis {
namespace {

// A static model that is hardly worse is preferred to a dynamic one.
constexpr double kStaticIsEnough = 1.02;
// Of the output's deviation.  Where neither explains anything, what is missing may be in front of a
// body or behind it.
constexpr double kExplains = 0.97;
constexpr double kSameChannel = 0.95;
// Of the error.  A mode that its bound hides leaves most of it; less may be what an effect
// leaves, which freer poles imitate (the shaking table of RESULTS: 0.92).
constexpr double kWorthSlowPoles = 0.5;

// Inverse dynamics: one input is the rate of another.
bool related(const Signals& signals) {
  const auto& inputs = signals.inputs();
  for (const Signal& one : inputs) {
    const std::vector<double> rate = differenced(one.values, signals.stretches());
    for (const Signal& other : inputs) {
      if (&other != &one && signal::correlation(rate, other.values) > kSameChannel) return true;
    }
  }
  return false;
}

// By parts held out whole, each from a start state: a body that holds a level says nothing without.
Trial judged_from_start(const Model& model, const Signals& signals, const Blocks& blocks,
                        int order) {
  FreeRun run;
  const Eigen::VectorXd residual = residual_of(model, signals, run);
  const auto given = kGivenForANumber * static_cast<std::size_t>(order);
  Trial trial{model, PartsOut(model, signals, blocks, residual, 1.0, given).from_start(model)};
  trial.rmse = trial.held_out.rmse();
  return trial;
}

// Its poles would have been allowed there: nothing held it back.
bool is_within_bounds_of(const Body& bound, Body body) {
  body.largest_radius = bound.largest_radius;
  body.slowest_radius = bound.slowest_radius;
  body.least_turn = bound.least_turn;
  return is_stable(body);
}

// A body that rings or holds a level for long, where the bound of its poles holds back the one that
// was fitted, Eq. DG-66.  True where it is kept.
bool allow_slow_poles(Baseline& baseline, Signals& signals, const Blocks& blocks, int order) {
  if (baseline.model.body.order() == 0 || !is_near_bound(baseline.model.body)) return false;
  double quick = judged_from_start(baseline.model, signals, blocks, order).rmse;
  // One that runs away on a part when it is fitted to the others says nothing of the order.
  for (auto p = static_cast<int>(baseline.model.body.order()); p > 1 && !std::isfinite(quick);) {
    baseline = fit_baseline(signals, blocks, --p);
    quick = judged_from_start(baseline.model, signals, blocks, order).rmse;
  }
  const Body body = baseline.model.body;
  const Signals slow = signals.with_slow_poles();
  std::vector<Baseline> fitted;
  std::vector<Trial> tried;
  for (int p = order; p > 0; --p) {
    Baseline other = fit_baseline(slow, blocks, p);
    Trial trial = judged_from_start(other.model, slow, blocks, order);
    if (is_within_bounds_of(body, other.model.body)) {
      quick = std::min(quick, trial.rmse);
      continue;
    }
    other.order = order;
    fitted.push_back(std::move(other));
    tried.push_back(std::move(trial));
  }
  if (tried.empty()) return false;
  const Trial& best = *std::ranges::min_element(tried, by_rmse);
  if (!(best.rmse < kWorthSlowPoles * quick)) return false;
  // Of those that tie, the one that explains most between samples that it knows.
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (!ties_with(tried[i], best, quick, {})) continue;
    const double rmse = held_out(tried[i].model, slow, blocks).rmse();
    if (!(rmse < least)) continue;
    least = rmse;
    baseline = fitted[i];
  }
  signals = slow;
  return true;
}

// @throws stillhand::ConfigError when a channel of the model is constant, or the output is an
// input, scaled.
void check_excitation(const Signals& signals, const std::string& source) {
  const auto constant = [](const Signal& signal) {
    return !(signal.deviation > 1e-12 * (std::abs(signal.mean) + 1e-300));
  };
  if (constant(signals.output())) {
    throw ConfigError(source + ", output '" + signals.output().name + "'", "a constant signal",
                      "one that moves");
  }
  for (const Signal& input : signals.inputs()) {
    if (constant(input)) {
      throw ConfigError(source + ", input '" + input.name + "'", "a constant signal",
                        "one that moves: without excitation there is nothing to fit");
    }
    if (std::abs(signal::correlation(input.values, signals.output().values)) > 1.0 - 1e-12) {
      throw ConfigError(source + ", output '" + signals.output().name + "'",
                        "the input '" + input.name + "' itself, scaled",
                        "a measured response to it");
    }
  }
}

// The model without effects, of the class that was asked for; "auto": static where a dynamic one
// is hardly better.  A body that rings for long (Eq. DG-66) may have slow poles.
// @param diagnosis  with its options; gets model class, baseline and a note
// @param signals    are those with slow poles, if the body has some
void fit_first_model(Diagnosis& diagnosis, Signals& signals, const Blocks& blocks) {
  const DiagnoseOptions& options = diagnosis.options;
  const bool asked = options.model == ModelClass::kArx;
  if (!asked) {
    diagnosis.model_class = "linear";
    diagnosis.baseline = fit_baseline(signals, blocks, 0);
    if (options.model == ModelClass::kLinear || related(signals)) return;
  }
  Baseline arx = fit_baseline(signals, blocks, options.order);
  Signals allowed = signals;
  const bool slow = allow_slow_poles(arx, allowed, blocks, options.order);
  const double still = held_out(diagnosis.baseline.model, signals, blocks).rmse();
  if (!asked && !slow && still < kExplains * signals.output().deviation &&
      still <= kStaticIsEnough * held_out(arx.model, signals, blocks).rmse()) {
    return;
  }
  diagnosis.model_class = "arx";
  diagnosis.baseline = std::move(arx);
  signals = std::move(allowed);
  if (slow) {
    diagnosis.notes.emplace_back(
        "the body is slow: a mode of it may ring for half of the recording, and a level stays");
  }
}

// A reason not to look for effects, if there is one.
void settle(Diagnosis& diagnosis, std::optional<NoModel> reason) {
  if (!reason) return;
  diagnosis.no_model = std::move(reason);
  diagnosis.options.search.most_effects = 0;
}

// Channels that another reading explains: exchanged, or one of them late.
std::optional<NoModel> channels_refused(const Measurement& working, const Signals& signals,
                                        const Blocks& blocks, const Model& baseline,
                                        const DiagnoseOptions& options) {
  std::optional<NoModel> reason =
      exchanged_of(working, signals, blocks, baseline, options.order, options.heaviest_kg);
  return reason ? reason : late_of(working, signals, blocks, baseline, options.order);
}

// Eq. DG-88: the whole diagnosis again, if it does not leave more than the search at this order.
std::optional<Diagnosis> at_higher_order(const Diagnosis& lower, const Measurement& measurement,
                                         const Signals& signals, const Blocks& blocks) {
  if (lower.no_model) return std::nullopt;
  DiagnoseOptions options = lower.options;
  const std::optional<int> order =
      order_instead(lower.model, signals, blocks, options.order,
                    lower.baseline.impulse_response_rmse, options.search);
  if (!order) return std::nullopt;
  const int before = std::exchange(options.order, *order);
  Diagnosis higher = diagnose(measurement, options);
  if (outdoes(held_out(lower.model, signals, blocks), held_out(higher.model, signals, blocks),
              options.search)) {
    return std::nullopt;
  }
  higher.notes.push_back("A body of order " + std::to_string(*order) +
                         " explains what one of order " + std::to_string(before) + " left.");
  return higher;
}

}  // namespace

bool Diagnosis::has_effect_that_counts() const {
  return std::ranges::any_of(effects, &FoundEffect::counts);
}

std::string Diagnosis::verdict() const {
  if (no_model) return "no model";
  if (has_effect_that_counts()) return "effects found";
  return unexplained ? "unexplained residual" : "nothing missing";
}

Diagnosis diagnose(const Measurement& measurement, const DiagnoseOptions& options) {
  const auto step = [&options](const std::string& name) {
    if (!options.progress(name)) throw Interrupted();
    return true;
  };
  check(measurement);
  Diagnosis diagnosis;
  diagnosis.options = options;
  diagnosis.screening = measurement.screening;
  settle(diagnosis, before_any_fit(measurement, options.inputs, options.output));
  step("preparing");
  const Measurement working = working_set(measurement, options.inputs);
  diagnosis.notes = working.notes;
  diagnosis.sample_rate_hz = working.rate_hz;
  Signals signals(working, options.inputs, options.output);
  diagnosis.output_unit = signals.output().unit;
  check_excitation(signals, working.source);
  const Blocks blocks = make_blocks(signals);
  step("baseline");
  fit_first_model(diagnosis, signals, blocks);
  const Model& baseline = diagnosis.baseline.model;
  if (!diagnosis.no_model)
    settle(diagnosis, channels_refused(working, signals, blocks, baseline, options));
  const Questions questions(signals);
  diagnosis.before = questions.of(Screening(baseline, signals, blocks, questions.impulse_response));
  diagnosis.search =
      search(diagnosis.baseline, signals, blocks, diagnosis.options.search, options.for_each, step);
  step("judging");
  take_found(diagnosis, signals, blocks);
  if (auto higher = at_higher_order(diagnosis, measurement, signals, blocks)) {
    return *std::move(higher);
  }
  judge(diagnosis, working, signals, blocks);
  look_at_the_rest(diagnosis, signals, blocks, questions);
  if (!diagnosis.no_model && options.search.most_effects > 0) {
    diagnosis.drawn_names = drawn_names(diagnosis.search, options.search);
  }
  return diagnosis;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/first_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/parts_out.hpp"

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

double correlation(const std::vector<double>& x, const std::vector<double>& y) {
  const Eigen::Map<const Eigen::VectorXd> a(x.data(), static_cast<Eigen::Index>(x.size()));
  const Eigen::Map<const Eigen::VectorXd> b(y.data(), static_cast<Eigen::Index>(y.size()));
  const Eigen::VectorXd left = a.array() - a.mean();
  const Eigen::VectorXd right = b.array() - b.mean();
  return left.dot(right) / std::max(left.norm() * right.norm(), 1e-300);
}

// Inverse dynamics: one input is the rate of another.
bool related(const Signals& signals) {
  const auto& inputs = signals.inputs();
  for (const Signal& one : inputs) {
    const std::vector<double> rate = differenced(one.values, signals.stretches());
    for (const Signal& other : inputs) {
      if (&other != &one && correlation(rate, other.values) > kSameChannel) return true;
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

}  // namespace

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
    if (std::abs(correlation(input.values, signals.output().values)) > 1.0 - 1e-12) {
      throw ConfigError(source + ", output '" + signals.output().name + "'",
                        "the input '" + input.name + "' itself, scaled",
                        "a measured response to it");
    }
  }
}

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

}  // namespace stillhand::diagnosis

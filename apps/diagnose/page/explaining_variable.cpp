// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/explaining_variable.hpp"

#include <algorithm>
#include <cmath>

#include "apps/diagnose/page/binning.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnose {
namespace {

using diagnosis::Effect;
using diagnosis::Parameter;
using diagnosis::Signal;
using diagnosis::Stage;

constexpr std::size_t kVariableBins = 40;
constexpr double kWorthMore = 0.05;        // a later candidate must explain this much more
constexpr double kDirectionMatters = 0.1;  // and the direction this much
constexpr double kLags_s[] = {0.0, 0.01, 0.02, 0.04, 0.06, 0.09, 0.13, 0.2, 0.3, 0.5};

std::vector<double> folded(const std::vector<double>& x, double period) {
  std::vector<double> y(x.size());
  for (std::size_t n = 0; n < x.size(); ++n) y[n] = x[n] - period * std::floor(x[n] / period);
  return y;
}

// Groups of variables that differ in their lag alone.
using Groups = std::vector<std::vector<Variable>>;

// One signal now and earlier.
void add_lagged(const Signal& signal, const diagnosis::Signals& signals, Groups& all) {
  std::vector<Variable> lags;
  std::size_t previous = SIZE_MAX;
  for (const double lag_s : kLags_s) {
    const auto lag = static_cast<std::size_t>(std::lround(lag_s * signals.rate_hz()));
    if (lag == previous) continue;
    previous = lag;
    std::string name = signal.name;
    if (lag > 0) {
      const double ms = 1000.0 * static_cast<double>(lag) / signals.rate_hz();
      name += " " + report::short_number(ms) + " ms earlier";
    }
    lags.push_back({axis_label(name, signal.unit),
                    diagnosis::lagged(signal.values, lag, signals.stretches())});
  }
  all.push_back(std::move(lags));
}

void add_periods(const Effect& effect, const diagnosis::Signals& signals, Groups& all) {
  for (const Parameter& parameter : effect.parameters) {
    if (!(parameter.value > 0.0)) continue;
    const double period = 1.0 / parameter.value;
    if (parameter.unit == "Hz") {
      all.push_back({{"time within a period of " + shown(period, "s") + " [s]",
                      folded(signals.time_s(), period)}});
    }
    for (const std::string& name : effect.channels) {
      const Signal& signal = signals.at(name);
      if (parameter.unit != "1/" + signal.unit) continue;
      all.push_back(
          {{axis_label(name + " within a period of " + shown(period, signal.unit), signal.unit),
            folded(signal.values, period)}});
    }
  }
}

void add_product(const Effect& effect, const diagnosis::Signals& signals, Groups& all) {
  if (effect.channels.size() != 2) return;
  const Signal& left = signals.at(effect.channels[0]);
  const Signal& right = signals.at(effect.channels[1]);
  std::vector<double> product(signals.size());
  for (std::size_t n = 0; n < product.size(); ++n) {
    product[n] = (left.values[n] - left.mean) * (right.values[n] - right.mean);
  }
  all.push_back(
      {{axis_label("product of " + left.name + " and " + right.name, left.unit + "·" + right.unit),
        std::move(product)}});
}

Groups candidates(const Evidence& evidence, const Effect& effect, const EffectTrace& trace) {
  const diagnosis::Signals& signals = evidence.signals;
  const auto& kind = diagnosis::effect_kind(effect.kind);
  Groups all;
  if (kind.stage(effect) == Stage::kOutputValue) {
    all.push_back(
        {{axis_label("prediction without it", evidence.found.output_unit), trace.run.prediction}});
  }
  if (kind.stage(effect) == Stage::kFeedback) {
    const Signal body{"the body's output",         {},   evidence.found.output_unit,
                      diagnosis::Quantity::kOther, true, evidence.after.run.body};
    add_lagged(body, signals, all);
  }
  add_periods(effect, signals, all);
  for (const std::string& name : effect.channels) add_lagged(signals.at(name), signals, all);
  add_product(effect, signals, all);
  if (kind.time_only(effect)) all.push_back({{"time [s]", signals.time_s()}});
  return all;
}

// The variable with every falling sample moved behind the rising ones, for bins of both.
std::vector<double> split(const std::vector<double>& x, const BinAxis& axis) {
  std::vector<double> y = x;
  const double width = axis.high - axis.low;
  for (std::size_t n = 1; n < x.size(); ++n) {
    y[n] = std::clamp(x[n], axis.low, axis.high) + (x[n] < x[n - 1] ? 1.001 * width : 0.0);
  }
  return y;
}

void judge(Variable& variable, const EffectTrace& trace, const std::vector<double>& weight) {
  const BinAxis axis = axis_over(variable.values, weight, kVariableBins);
  variable.share = share_between_bins(axis, variable.values, trace.contribution, weight);
  const std::vector<double> both = split(variable.values, axis);
  const BinAxis twice{axis.low, axis.low + 2.001 * (axis.high - axis.low), 2 * kVariableBins};
  const double share = share_between_bins(twice, both, trace.contribution, weight);
  if (share < variable.share + kDirectionMatters) return;
  variable.share = share;
  variable.by_direction = true;
}

// The best of a group, or its first where that is as good.
Variable best_of_group(std::vector<Variable> group, const EffectTrace& trace,
                       const std::vector<double>& weight) {
  for (Variable& each : group) judge(each, trace, weight);
  const auto best = std::ranges::max_element(group, {}, &Variable::share);
  return std::move(group.front().share + kWorthMore >= best->share ? group.front() : *best);
}

}  // namespace

std::optional<Variable> explaining_variable(const Evidence& evidence, const Effect& effect,
                                            const EffectTrace& trace) {
  std::optional<Variable> best;
  for (std::vector<Variable>& group : candidates(evidence, effect, trace)) {
    Variable each = best_of_group(std::move(group), trace, evidence.after.run.weight);
    if (!best || each.share > best->share + kWorthMore) best = std::move(each);
  }
  return best;
}

}  // namespace stillhand::diagnose

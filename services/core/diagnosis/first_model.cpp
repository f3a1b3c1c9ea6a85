// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/first_model.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/fitting/held_out.hpp"

namespace stillhand::diagnosis {
namespace {

// A static model that is hardly worse is preferred to a dynamic one.
constexpr double kStaticIsEnough = 1.02;
constexpr double kSameChannel = 0.95;
// Of the held-out error.  A mode that its bound hides leaves most of it; less may be what an effect
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

Baseline chosen_baseline(const Signals& signals, const Blocks& blocks,
                         const DiagnoseOptions& options, std::string& name) {
  if (options.model == ModelClass::kArx) {
    name = "arx";
    return fit_baseline(signals, blocks, options.order);
  }
  Baseline linear = fit_baseline(signals, blocks, 0);
  name = "linear";
  if (options.model == ModelClass::kLinear || related(signals)) return linear;
  Baseline arx = fit_baseline(signals, blocks, options.order);
  const double static_rmse = held_out(linear.model, signals, blocks).rmse();
  if (static_rmse <= kStaticIsEnough * held_out(arx.model, signals, blocks).rmse()) return linear;
  name = "arx";
  return arx;
}

// A body that rings or holds a level for long, where the bound of its poles holds back the one that
// was fitted, Eq. DG-66.
void allow_slow_poles(Diagnosis& diagnosis, Signals& signals, const Blocks& blocks) {
  const Body& body = diagnosis.baseline.model.body;
  if (body.order() == 0 || !is_near_bound(body)) return;
  const Signals slow = signals.with_slow_poles();
  Baseline other = fit_baseline(slow, blocks, diagnosis.options.order);
  const double before = held_out(diagnosis.baseline.model, signals, blocks).rmse();
  if (!(held_out(other.model, slow, blocks).rmse() < kWorthSlowPoles * before)) return;
  diagnosis.baseline = std::move(other);
  signals = slow;
  diagnosis.notes.emplace_back(
      "the body is slow: a mode of it may ring for half of the recording, and a level stays");
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
  diagnosis.baseline = chosen_baseline(signals, blocks, diagnosis.options, diagnosis.model_class);
  allow_slow_poles(diagnosis, signals, blocks);
}

}  // namespace stillhand::diagnosis

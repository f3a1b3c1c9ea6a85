// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/examples.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "services/core/diagnosis/model/effect_kind.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kPart = 0.1;  // [-] of a gain, a slope or a stiffness

// One number, which nothing fits.
Effect with(const char* kind, const char* form, std::vector<std::string> channels, double value,
            std::vector<double> coefficients = {}) {
  return {kind,
          form,
          std::move(channels),
          {constant("of an example", "-", value)},
          std::move(coefficients)};
}

bool changes_sign(const Signal& signal) {
  const auto [low, high] = std::ranges::minmax(signal.values);
  return low < 0.0 && high > 0.0;
}

std::vector<Effect> of_channel(const Signal& signal, const Signals& signals) {
  constexpr double kPeriods = 7.0;  // of a ripple within the range
  const std::vector<std::string> own{signal.name};
  std::vector<Effect> all;
  if (!signal.derived && !signals.is_input(signal.name)) {
    all.push_back({"coupled_input", "static", own, {}, {1.0}});
    all.push_back({"bilinear",
                   "beside the body",
                   {signals.inputs().front().name, signal.name},
                   {constant("centre_1", "-", signals.inputs().front().mean),
                    constant("centre_2", "-", signal.mean)},
                   {1.0}});
  }
  if (signal.quantity == Quantity::kRate && changes_sign(signal)) {
    all.push_back({"coulomb_friction", "sign, beside the body", own, {}, {1.0}});
  }
  if (signal.quantity == Quantity::kPosition) {
    const auto [low, high] = std::ranges::minmax(signal.values);
    all.push_back(
        with("position_ripple", "one harmonic", own, kPeriods / (high - low), {1.0, 0.0}));
  }
  return all;
}

std::vector<Effect> of_time(const Signals& signals) {
  constexpr double kDrift_s = 0.02;  // between the clocks, over the record
  const double length_s = signals.duration_s();
  const double middle_hz = std::sqrt(signals.lowest_excited_hz() * signals.highest_excited_hz());
  return {{"drift", "linear", {}, {}, {1.0}},
          with("tone", "beside the body", {}, middle_hz, {1.0, 0.0}),
          with("time_varying_gain", "linear", {}, kPart),
          {"regime_change",
           "step of the gain",
           {},
           {constant("time", "s", 0.5 * length_s), constant("change", "-", kPart)},
           {}},
          {"clock_drift",
           "of the output",
           {},
           {constant("drift", "us/s", 1e6 * kDrift_s / length_s),
            constant("reference_time", "s", signals.time_s().front() + 0.5 * length_s)},
           {}}};
}

std::vector<Effect> of_maps(const Signals& signals) {
  const Signal& input = signals.inputs().front();
  const double y = signals.output().deviation;
  return {with("delay", "of the input", {}, 0.03),
          with("input_saturation", "hard", {input.name}, 1.5 * input.deviation),
          with("dead_zone", "at the input", {input.name}, 0.2 * input.deviation),
          with("output_saturation", "hard", {}, 1.5 * y),
          with("asymmetry", "slopes at the output", {}, kPart)};
}

// Around the body's output, a tenth of its stiffness; of a static model at its output.
std::vector<Effect> of_springs(const Model& model, const Signals& signals) {
  const double y = signals.output().deviation;
  const auto& a = model.body.denominator;
  if (model.body.order() == 0 || feedback_of(model) != nullptr) {
    return {with("nonlinear_stiffness", "at the output", {}, kPart / (y * y))};
  }
  std::vector<double> path(model.body.order(), 0.0);
  path.front() = -kPart * y * std::accumulate(a.begin(), a.end(), 0.0);
  return {with("nonlinear_stiffness", "bent of the output", {}, y, path),
          with("hysteresis", "elastic-plastic of the output", {}, 0.5 * y, path)};
}

// A mode of the first input in the middle of the band.
Effect mode_of(const Signals& signals) {
  constexpr double kDamping = 0.035;
  std::vector<double> factors(2 * signals.inputs().size(), 0.0);
  factors[1] = 1.0;
  return {"resonance",
          "beside the body",
          {},
          {constant("frequency", "Hz",
                    std::sqrt(signals.lowest_excited_hz() * signals.highest_excited_hz())),
           constant("damping_ratio", "-", kDamping)},
          factors};
}

// Half a second in the middle.
Effect burst_of(const Signals& signals) {
  const double middle_s = signals.time_s().front() + 0.5 * signals.duration_s();
  return {"transients",
          "isolated bursts",
          {},
          {constant("begin_1", "s", middle_s - 0.25), constant("end_1", "s", middle_s + 0.25)},
          {}};
}

}  // namespace

std::vector<Effect> examples(const Model& model, const Signals& signals) {
  std::vector<Effect> all = of_maps(signals);
  const auto add = [&all](std::vector<Effect> more) {
    std::ranges::move(more, std::back_inserter(all));
  };
  add(of_springs(model, signals));
  if (model.body.order() > 0) all.push_back(mode_of(signals));
  add(of_time(signals));
  for (const Signal& signal : signals.all()) add(of_channel(signal, signals));
  all.push_back(burst_of(signals));
  for (const EffectKind* kind : effect_kinds()) {
    const auto* const own = dynamic_cast<const MakesExamples*>(kind);
    if (own != nullptr) add(own->examples(model, signals));
  }
  return all;
}

}  // namespace stillhand::diagnosis

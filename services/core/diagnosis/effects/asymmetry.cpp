// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/loop_proposals.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/fitting/lost_sign.hpp"
#include "services/core/diagnosis/model/loop_sizes.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLargestSlopeChange = 0.9;  // of a half-line's slope change
constexpr const char* kSize = "size at the output";
constexpr const char* kSquare = "square at the input";
constexpr int kMostPoles = 4;  // of a body behind which only the size is measured

// The share s of the square, which is as large as u itself at the largest input.
double square_mixed(double u, double share, double largest) {
  return u + share * (u * u / largest - u);
}

bool quadratic(const Effect& effect) { return effect.form.starts_with("square"); }

std::string square_in_words(const Effect& effect) {
  constexpr double kIsSquare = 0.02;
  const std::string& input = effect.channels.front();
  const std::string largest = with_unit(effect.value(1), effect.parameters[1].unit);
  if (std::abs(effect.value(0) - 1.0) < kIsSquare) {
    return input + " acts by its square, within 2 % of it at " + largest;
  }
  return input + " acts by itself and its square, " + with_unit(effect.value(0), "") +
         " of the square at " + largest;
}

/// A response that differs with the direction, an even function of a signal:
///
///   v + k |v| of input or output;  u + s (u^2/u_m - u) of the input;  |v| of the output;
///   feedback of |z| or z^2 inside the body;  c (x - m)^2 of a channel
///
/// Source: METHOD Eq. DG-25; bilinear and quadratic stiffness: Worden and Tomlinson (2001).
class Asymmetry final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "asymmetry"; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    if (effect.form == "slopes at the output" || effect.form == kSize) return Stage::kOutputValue;
    if (effect.form == "slopes at the input" || effect.form == kSquare) return Stage::kInputValue;
    return effect.channels.empty() ? Stage::kFeedback : Stage::kTerm;
  }
  // Slope 1 + kappa for positive, 1 - kappa for negative values.
  [[nodiscard]] double mapped(const Effect& effect, double value) const override {
    if (effect.form == kSize) return std::abs(value);
    if (effect.form == kSquare) return square_mixed(value, effect.value(0), effect.value(1));
    return value + effect.value(0) * std::abs(value);
  }
  [[nodiscard]] double slope(const Effect& effect, double value) const override {
    if (effect.form == kSize) return std::copysign(1.0, value);
    return 1.0 + (value > 0.0 ? effect.value(0) : -effect.value(0));
  }
  [[nodiscard]] Nonlinearity feedback(const Effect& effect) const override {
    if (quadratic(effect)) {
      return {[](double z, LoopMemory& /*memory*/) { return z * z; }, threshold_of(effect)};
    }
    return {[](double z, LoopMemory& /*memory*/) { return std::abs(z); }, threshold_of(effect)};
  }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& signal = signals.at(effect.channels.at(0));
    std::vector<double> even(signals.size());
    for (std::size_t n = 0; n < even.size(); ++n) {
      const double x = signal.values[n] - effect.value(0);
      even[n] = quadratic(effect) ? x * x : std::abs(x);
    }
    columns.push_back(std::move(even));
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t /*i*/) const override {
    const std::string& unit = signals.at(effect.channels.at(0)).unit;
    return quadratic(effect) ? unit_power(unit, 2) : unit;
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override;
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    if (!effect.channels.empty() && stage(effect) == Stage::kTerm) {
      return "the residual has an even part in " + effect.channels.front();
    }
    if (effect.form == kSquare) return square_in_words(effect);
    if (effect.form == kSize) return "the output is the size of the response, without its sign";
    return "pushing and pulling differ: an even part, " + effect.form;
  }
};

std::vector<Size> Asymmetry::sizes(const SizeCase& at) const {
  const Effect& effect = at.effect();
  if (effect.form == kSquare) return {};
  if (effect.form == kSize) {
    return {{"level_at_rest", at.model.output_unit, at.model.body.offset,
             "of the response whose size is measured, without input"}};
  }
  if (stage(effect) == Stage::kTerm) {
    const Signal& signal = at.signals.at(effect.channels.at(0));
    const double x = largest_deflection(signal.values, effect.value(0), at.signals);
    const double factor =
        through_body(effect) ? through_body_at(at, 0.0).real() : effect.coefficients.at(0);
    return {{"even_force", at.model.output_unit, factor * (quadratic(effect) ? x * x : x),
             "at " + with_unit(x, signal.unit) + " from the centre, the largest seen" +
                 (through_body(effect) ? ", at 0 Hz behind the body" : "")}};
  }
  if (stage(effect) != Stage::kFeedback) {
    const double kappa = effect.value(0);
    return {{"slope_ratio", "-", (1.0 + kappa) / (1.0 - kappa),
             "of positive values over that of negative ones"}};
  }
  const double slope = std::copysign(1.0, output_over_argument(at)) *
                       (quadratic(effect) ? 2.0 * largest_argument(at) : 1.0);
  std::string where = "where the output is positive, over that where it is negative";
  if (quadratic(effect)) where += ", at the largest motion seen";
  return {stiffness_ratio(at, slope, -slope, where)};
}

// Where no output is below zero, and nothing else is in the model yet: with bodies of every order,
// since the one that was fitted to the size is none of the response.
std::vector<Proposal> size_proposals(const Screening& screening) {
  constexpr double kBelow = 0.05;  // of the output's deviation: its noise about zero
  const Signal& output = screening.signals().output();
  if (!screening.model().effects.empty() ||
      quantile_of(output.values, 0.01) < -kBelow * output.deviation) {
    return {};
  }
  const std::vector<double> y = with_lost_sign(screening.signals());
  if (std::ranges::none_of(y, [](double each) { return each < 0.0; })) return {};
  std::vector<Proposal> proposals;
  for (int order = 1; order <= kMostPoles; ++order) {
    proposals.push_back(with_body(screening, {"asymmetry", kSize, {}, {}, {}},
                                  new_body(screening, measured_inputs(screening), y, order)));
  }
  return best_of(std::move(proposals), 2);
}

std::vector<Proposal> square_proposals(const Screening& screening) {
  const Signal& input = screening.signals().inputs().front();
  double largest = 0.0;
  for (const double u : input.values) largest = std::max(largest, std::abs(u));
  const Effect effect{
      "asymmetry",
      kSquare,
      {input.name},
      {{"square_share", "-", 1.0, -2.0, 2.0}, constant("largest_input", input.unit, largest)},
      {}};
  return input_map_proposals(
      screening, effect, {1.0, 0.4, -0.4},
      [largest](double u, double share) { return square_mixed(u, share, largest) - u; });
}

std::vector<Proposal> Asymmetry::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> proposals;
  append(proposals, loop_proposals(
                        screening, "asymmetry", "slopes",
                        [](double z, LoopMemory& /*memory*/) { return std::abs(z); }, true));
  append(proposals, loop_proposals(
                        screening, "asymmetry", "square",
                        [](double z, LoopMemory& /*memory*/) { return z * z; }, true));
  std::vector<double> size = screening.prediction();
  for (double& y : size) y = std::abs(y);
  const ScreenedGain at_output = screening.gain({size});
  proposals.push_back({{"asymmetry",
                        "slopes at the output",
                        {},
                        {{"slope_change", "-", std::clamp(at_output.coefficients[0], -0.5, 0.5),
                          -kLargestSlopeChange, kLargestSlopeChange}},
                        {}},
                       at_output.share,
                       {}});
  const Signal& input = signals.inputs().front();
  std::vector<double> rectified = input.values;
  for (double& u : rectified) u = std::abs(u);
  const ScreenedGain at_input = screening.gain({response_of(screening, rectified)});
  proposals.push_back({{"asymmetry",
                        "slopes at the input",
                        {input.name},
                        {{"slope_change", "-", std::clamp(at_input.coefficients[0], -0.5, 0.5),
                          -kLargestSlopeChange, kLargestSlopeChange}},
                        {}},
                       at_input.share,
                       {}});
  std::vector<Proposal> of_channels;
  for (const Signal& signal : signals.all()) {
    if (signal.derived) continue;
    for (const char* form : {"square, beside the body", "square, through the body"}) {
      of_channels.push_back(screening.with_coefficients(
          {"asymmetry", form, {signal.name}, {constant("centre", signal.unit, signal.mean)}, {}}));
    }
  }
  append(proposals, best_of(std::move(of_channels), 1));
  proposals = best_of(std::move(proposals), 4);
  append(proposals, square_proposals(screening));
  append(proposals, size_proposals(screening));
  return proposals;
}

}  // namespace

const EffectKind& asymmetry_kind() {
  static const Asymmetry kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

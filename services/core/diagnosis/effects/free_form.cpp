// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/effects/smooth_curve.hpp"
#include "services/core/diagnosis/fitting/baseline.hpp"
#include "services/core/diagnosis/model/loop_sizes.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr const char* kForce = "force over a channel";
constexpr const char* kFactor = "factor over a channel";
constexpr const char* kGain = "gain over a channel";
constexpr const char* kSize = "gain over the size of an input";
constexpr const char* kCurve = "curve of the input";

// Shares of the samples below each knot: close in the middle, where there are many samples.
constexpr std::array kKnotShares{0.01, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99};
// Of a curve in front of the body, whose ends move the output for long.
constexpr std::array kInputShares{0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0};
constexpr double kMemories_s[] = {0.5, 2.0, 8.0};
constexpr double kLargestChange = 3.0;
constexpr std::size_t kMostProposals = 5;
constexpr double kRowsForANumber = 4.0;  // of a body for each hat of the input

std::vector<double> named(const Effect& effect, std::string_view prefix) {
  std::vector<double> values;
  for (const Parameter& parameter : effect.parameters) {
    if (parameter.name.starts_with(prefix)) values.push_back(parameter.value);
  }
  return values;
}

// @throws std::out_of_range for what no search made: a file's
std::vector<double> knots_of(const Effect& effect) {
  std::vector<double> knots = named(effect, "knot_");
  const auto not_above = [](double a, double b) { return !(a < b); };
  if (knots.size() < 2 || std::ranges::adjacent_find(knots, not_above) != knots.end()) {
    throw std::out_of_range("two knots or more, ascending");
  }
  return knots;
}

// A value's place between two knots: `share` of the way from knot `below` to the next.
struct Place {
  std::size_t below;
  double share;
};

Place place_of(double value, const std::vector<double>& knots) {
  const auto above = std::ranges::upper_bound(knots, value);
  if (above == knots.begin()) return {0, 0.0};
  if (above == knots.end()) return {knots.size() - 2, 1.0};
  const auto below = static_cast<std::size_t>(above - knots.begin()) - 1;
  return {below, (value - knots[below]) / (knots[below + 1] - knots[below])};
}

// The curve is counted from this knot: its level there belongs to the offset or the body's gain.
std::size_t centre(std::size_t knots) { return knots / 2; }

// RMS with a memory, from that of each stretch's first second.
std::vector<double> size_of(const std::vector<double>& values, double memory_s,
                            const Signals& signals) {
  const double keep = std::exp(-1.0 / (memory_s * signals.rate_hz()));
  std::vector<double> size(values.size());
  for (const Stretch& stretch : signals.stretches()) {
    const std::size_t first = std::min(
        stretch.end, stretch.first + static_cast<std::size_t>(std::ceil(signals.rate_hz())));
    double square = 0.0;
    for (std::size_t n = stretch.first; n < first; ++n) square += values[n] * values[n];
    square /= static_cast<double>(first - stretch.first);
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      square = keep * square + (1.0 - keep) * values[n] * values[n];
      size[n] = std::sqrt(square);
    }
  }
  return size;
}

// What the curve is over, one value a sample.  Not time: time_varying_gain has a curve over it.
std::vector<double> argument(const Effect& effect, const Signals& signals) {
  if (effect.channels.empty()) throw std::out_of_range("a channel");
  const std::vector<double>& values = signals.at(effect.channels.back()).values;
  if (effect.form != kSize) return values;
  const double memory_s = effect.parameters.at(0).value;
  if (!(memory_s > 0.0)) throw std::out_of_range("a memory above 0");
  return size_of(values, memory_s, signals);
}

std::vector<double> knots_over(const std::vector<double>& values, const std::vector<double>& weight,
                               std::span<const double> shares = kKnotShares) {
  std::vector<double> counted;
  for (std::size_t n = 0; n < values.size(); ++n) {
    if (weight[n] > 0.0) counted.push_back(values[n]);
  }
  if (counted.empty()) return {};
  std::ranges::sort(counted);
  const auto at = [&](double share) {
    return counted[static_cast<std::size_t>(share * static_cast<double>(counted.size() - 1))];
  };
  const double least = kKnotsApart * (at(shares.back()) - at(shares.front()));
  std::vector<double> knots;
  for (const double share : shares) {
    if (knots.empty() || at(share) - knots.back() > least) knots.push_back(at(share));
  }
  return knots.size() < kFewestKnots ? std::vector<double>{} : knots;
}

// L_k of every sample times `factor`, all knots but `without`.
Columns hats(const std::vector<double>& over, const std::vector<double>& knots,
             const std::vector<double>* factor, std::optional<std::size_t> without) {
  Columns columns(knots.size(), std::vector<double>(over.size(), 0.0));
  for (std::size_t n = 0; n < over.size(); ++n) {
    const Place place = place_of(over[n], knots);
    const double size = factor == nullptr ? 1.0 : (*factor)[n];
    columns[place.below][n] = (1.0 - place.share) * size;
    columns[place.below + 1][n] = place.share * size;
  }
  if (without) columns.erase(columns.begin() + static_cast<std::ptrdiff_t>(*without));
  return columns;
}

bool is_gain(const Effect& effect) { return effect.form == kGain || effect.form == kSize; }

double height_at(const Effect& effect, double value) { return SmoothCurve(effect).at(value); }

// 1 at the centre, 1 + change at the others.
std::vector<double> factors_of(const Effect& effect) {
  std::vector<double> factors = named(effect, "change_");
  for (double& factor : factors) factor += 1.0;
  factors.insert(factors.begin() + static_cast<std::ptrdiff_t>(centre(factors.size() + 1)), 1.0);
  return factors;
}

// @throws std::out_of_range for what no search made
Curve map_of(const Effect& effect) {
  Curve curve;
  curve.of = "part of " + effect.channels.at(0) + " that acts";
  curve.over = effect.channels.at(0);
  curve.over_unit = effect.parameters.at(0).unit;
  curve.knots = knots_of(effect);
  curve.heights = named(effect, "height_");
  return curve;
}

// @throws std::out_of_range for what no search made
Curve shape_of(const Effect& effect) {
  if (effect.channels.empty()) throw std::out_of_range("a channel");
  if (effect.form == kCurve) return map_of(effect);
  Curve curve;
  curve.knots = knots_of(effect);
  curve.pure_number = is_gain(effect);
  curve.of = curve.pure_number ? "gain" : "force";
  curve.over = effect.channels.back();
  if (effect.form == kFactor) curve.of = "factor on " + effect.channels.at(0);
  if (effect.form == kSize) {
    curve.over =
        "the RMS of " + effect.channels.at(0) + " in the last " + with_unit(effect.value(0), "s");
  }
  for (const Parameter& parameter : effect.parameters) {
    if (parameter.name == "knot_1") curve.over_unit = parameter.unit;
  }
  curve.heights = curve.pure_number ? factors_of(effect) : effect.coefficients;
  for (std::size_t i = 0; i < curve.knots.size(); ++i) curve.fitted.emplace_back(i);
  if (effect.form != kFactor) {
    const std::size_t middle = centre(curve.knots.size());
    if (!curve.pure_number) {
      curve.heights.insert(curve.heights.begin() + static_cast<std::ptrdiff_t>(middle), 0.0);
    }
    curve.fitted.insert(curve.fitted.begin() + static_cast<std::ptrdiff_t>(middle), std::nullopt);
    curve.fitted.pop_back();
  }
  return curve;
}

/// A curve whose shape the data alone give: straight between knots, level beyond the outer ones,
///
///   h(x) = sum_k c_k L_k(x),  L_k: 1 at knot k, 0 at every other knot
///
/// as a force h(x) or h(x) v, or as a factor 1 + h(x) on the body's output, x a channel or the
/// size of an input (its RMS over some seconds).  Or a smooth curve m(u) in place of the first
/// input.  When it is tried: Eq. DG-64.
///
/// Source: METHOD Eq. DG-63; Hastie, Tibshirani and Friedman (2009), section 5.2 (basis of linear
/// splines).
class FreeForm final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "free_form"; }
  [[nodiscard]] bool any_shape() const override { return true; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    if (effect.form == kCurve) return Stage::kInputValue;
    if (effect.form == kCurveInside) return Stage::kFeedback;
    return is_gain(effect) ? Stage::kGain : Stage::kTerm;
  }
  [[nodiscard]] double mapped(const Effect& effect, double value) const override {
    return height_at(effect, value);
  }
  [[nodiscard]] Nonlinearity feedback(const Effect& effect) const override {
    return law_of_curve(effect);
  }
  [[nodiscard]] std::optional<Effect> drawn_after(
      const std::vector<double>& argument, const std::vector<double>& phi,
      const std::vector<double>& weight) const override {
    return curve_through(argument, phi, weight);
  }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const std::vector<double> knots = knots_of(effect);
    const bool force = effect.form == kForce;
    const std::vector<double>* factor = force ? nullptr : &signals.at(effect.channels.at(0)).values;
    for (auto& column : hats(argument(effect, signals), knots, factor,
                             force ? std::optional(centre(knots.size())) : std::nullopt)) {
      columns.push_back(std::move(column));
    }
  }
  void gain(const Effect& effect, const Signals& signals, std::span<double> gain) const override {
    const std::vector<double> knots = knots_of(effect);
    const std::vector<double> factors = factors_of(effect);
    if (factors.size() != knots.size()) throw std::out_of_range("a change for each knot but one");
    const std::vector<double> over = argument(effect, signals);
    for (std::size_t n = 0; n < gain.size(); ++n) {
      const Place place = place_of(over[n], knots);
      gain[n] *=
          (1.0 - place.share) * factors[place.below] + place.share * factors[place.below + 1];
    }
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t /*i*/) const override {
    return effect.form == kFactor ? signals.at(effect.channels.at(0)).unit : "-";
  }
  // Next to the body or in front of it, a curve that one recording drew is no law for a motor.
  // Inside it is held at the ends of its range and bounded as any spring is.
  [[nodiscard]] ControlRole body_role(const Effect& effect) const override {
    if (effect.form == kCurveInside) return EffectKind::body_role(effect);
    return control::LeftOut{"a curve without a named law"};
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    if (at.effect().form == kCurveInside) {
      const auto [low, high] = std::ranges::minmax(SmoothCurve(at.effect()).bends());
      return {{"range", at.model.output_unit, std::abs(output_over_phi(at)) * (high - low),
               "of the curve without its straight part, from the lowest knot to the highest, at 0 "
               "Hz"}};
    }
    const Curve shape = shape_of(at.effect());
    const auto [low, high] = std::ranges::minmax(shape.heights);
    std::string unit = shape.pure_number ? "-" : at.model.output_unit;
    if (at.effect().form == kCurve) unit = shape.over_unit;
    if (at.effect().form == kFactor) {
      unit = unit_over(unit, at.signals.at(at.effect().channels.at(0)).unit);
    }
    return {{"range", unit, high - low,
             "of the " + shape.of + ", from the lowest knot to the highest"}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override;
  [[nodiscard]] std::optional<Curve> curve(const Effect& effect,
                                           const Signals& signals) const override {
    if (effect.form == kCurve || effect.form == kCurveInside) return {};  // its law shows it
    Curve curve = shape_of(effect);
    if (effect.form == kFactor) curve.per = signals.at(effect.channels.at(0)).unit;
    return curve;
  }
};

std::string FreeForm::evidence(const Effect& effect) const {
  if (effect.form == kCurveInside) {
    return "no named kind bends as the curve inside the body does; " + slopes_in_words(effect);
  }
  const Curve shape = shape_of(effect);
  std::string text =
      "no named kind has this shape; the " + shape.of + " over " + shape.over + " is";
  for (std::size_t k = 0; k < std::min(shape.knots.size(), shape.heights.size()); ++k) {
    text += (k == 0 ? " " : ", ") + with_unit(shape.heights[k], "") + " at " +
            with_unit(shape.knots[k], shape.over_unit);
  }
  return text;
}

// Each hat of the input through a body of its own, with common poles: the numerators are a rank of
// one, heights times a body, in the metric of what they add to the output (Bai, Automatica 34,
// 1998).
std::vector<double> heights_of(const Screening& screening, const Columns& hats, int order) {
  const Signals& signals = screening.signals();
  Columns inputs = measured_inputs(screening);
  inputs.erase(inputs.begin());
  inputs.insert(inputs.begin(), hats.begin(), hats.end());
  const Body body = started_body(inputs, signals.output().values, {}, signals, order);
  const std::vector<double>& u = signals.inputs().front().values;
  Eigen::MatrixXd lags(std::ssize(u), order + 1);
  std::vector<double> x = through_poles(u, body.denominator, signals.stretches());
  Eigen::MatrixXd numerators(std::ssize(hats), order + 1);
  for (int i = 0; i <= order; ++i) {
    if (i > 0) x = differenced(x, signals.stretches());
    lags.col(i) = Eigen::Map<const Eigen::VectorXd>(x.data(), std::ssize(x));
  }
  for (Eigen::Index k = 0; k < numerators.rows(); ++k) {
    const auto row = difference_basis(body.numerators[static_cast<std::size_t>(k)]);
    numerators.row(k) = Eigen::Map<const Eigen::RowVectorXd>(row.data(), std::ssize(row));
  }
  if (!lags.allFinite()) return {};
  const Eigen::MatrixXd added = numerators * signal::upper_factor(lags).transpose();
  // Power steps: the first direction is all that is asked.
  Eigen::VectorXd heights = added.rowwise().norm();
  for (int step = 0; step < 50; ++step)
    heights = (added * (added.transpose() * heights)).normalized();
  return {heights.begin(), heights.end()};
}

// Of the curve the offset and the gain are the body's: the centre is held at its knot, and the
// height that is furthest from it.
std::optional<Proposal> curve_of_input(const Screening& screening, Effect effect,
                                       const std::vector<double>& knots) {
  if (!screening.model().effects.empty() || screening.model().body.order() == 0) return {};
  const auto order = static_cast<int>(screening.model().body.order());
  const std::size_t middle = centre(knots.size());
  const Signal& input = screening.signals().inputs().front();
  const Columns inputs = hats(input.values, knots, nullptr, middle);
  if (sum_of(screening.weight()) <
      kRowsForANumber * static_cast<double>(inputs.size() + 1) * (order + 1))
    return {};
  std::vector<double> heights = heights_of(screening, inputs, order);
  if (heights.empty()) return {};
  heights.insert(heights.begin() + static_cast<std::ptrdiff_t>(middle), 0.0);
  const auto size = [](double height) { return std::abs(height); };
  const auto furthest =
      static_cast<std::size_t>(std::ranges::max_element(heights, {}, size) - heights.begin());
  const double scale = (knots[furthest] - knots[middle]) / heights[furthest];
  const double range = knots.back() - knots.front();
  for (std::size_t k = 0; k < knots.size(); ++k) {
    const std::string name = "height_" + std::to_string(k + 1);
    const double height = knots[middle] + scale * heights[k];
    const bool held = k == middle || k == furthest;
    effect.parameters.push_back(
        held ? constant(name, input.unit, height)
             : Parameter{name, input.unit, height, height - 5.0 * range, height + 5.0 * range});
  }
  std::vector<std::vector<double>> mapped = measured_inputs(screening);
  for (double& u : mapped.front()) u = height_at(effect, u);
  return with_body(screening, effect,
                   new_body(screening, mapped, screening.signals().output().values));
}

std::vector<Proposal> FreeForm::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> proposals;
  const auto propose_term = [&](Effect effect) {
    proposals.push_back(screening.with_coefficients(std::move(effect)));
  };
  const auto propose_gain = [&](Effect effect) {
    const std::vector<double> knots = knots_of(effect);
    const ScreenedGain found = screening.gain(
        hats(argument(effect, signals), knots, &screening.body_output(), centre(knots.size())));
    for (std::size_t i = 0; i < found.coefficients.size(); ++i) {
      effect.parameters.push_back(
          {"change_" + std::to_string(i + 1), "-",
           std::clamp(found.coefficients[i], -kLargestChange, kLargestChange), -kLargestChange,
           kLargestChange});
    }
    proposals.push_back({std::move(effect), found.share, {}});
  };
  for (const Signal& signal : signals.all()) {
    const std::vector<double> knots = knots_over(signal.values, screening.weight());
    if (knots.empty()) continue;
    propose_term(with_knots(kForce, {signal.name}, signal.unit, knots));
    if (const Signal* rate = signals.rate_of(signal); rate != nullptr && rate != &signal) {
      propose_term(with_knots(kFactor, {rate->name, signal.name}, signal.unit, knots));
    }
    if (!signal.derived) propose_gain(with_knots(kGain, {signal.name}, signal.unit, knots));
  }
  const Signal& first = signals.inputs().front();
  if (const auto knots = knots_over(first.values, screening.weight(), kInputShares);
      !knots.empty()) {
    auto curve =
        curve_of_input(screening, with_knots(kCurve, {first.name}, first.unit, knots), knots);
    if (curve) proposals.push_back(std::move(*curve));
  }
  for (const Signal& input : signals.inputs()) {
    for (const double memory_s : kMemories_s) {
      const auto knots = knots_over(size_of(input.values, memory_s, signals), screening.weight());
      if (knots.empty()) continue;
      Effect effect = with_knots(kSize, {input.name}, input.unit, knots);
      effect.parameters.insert(effect.parameters.begin(), constant("memory", "s", memory_s));
      propose_gain(std::move(effect));
    }
  }
  return best_of(std::move(proposals), kMostProposals);
}

}  // namespace

const EffectKind& free_form_kind() {
  static const FreeForm kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

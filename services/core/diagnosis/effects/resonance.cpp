// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/diagnosis/model/steady_start.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kTriedDamping[] = {0.012, 0.035, 0.1, 0.3};
constexpr double kStep = 2.0;  // between tried frequencies, in damping ratios: half power and half
constexpr double kLowest_hz = 0.3;
constexpr double kHighestModeOfRate = 0.4;
constexpr double kLeastDamping = 0.003;
constexpr double kLargestDamping = 0.95;
constexpr double kLongestRinging = 0.125;  // [record lengths]

/// A mode beyond the body's order, of frequency f and damping ratio z, for each input u_k:
///
///   (c_k,1 D + c_k,2) x_k,  x_k = u_k / (1 - 2 r cos(w sqrt(1 - z^2)) q^-1 + r^2 q^-2),
///   r = e^(-z w),  w = 2 pi f T
///
/// Source: METHOD Eq. DG-21.
class Resonance final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "resonance"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const auto denominator = mode_denominator(effect.value(0), effect.value(1), signals.rate_hz());
    for (const Signal& input : signals.inputs()) {
      Settled x = through_poles(settled(input.values, signals), denominator, signals.stretches());
      columns.push_back(differenced(x, signals.stretches()).values);
      columns.push_back(std::move(x.values));
    }
  }
  [[nodiscard]] std::string column_unit(const Effect& /*effect*/, const Signals& /*signals*/,
                                        std::size_t /*i*/) const override {
    return {};
  }
  [[nodiscard]] std::vector<double> own_poles(const Effect& effect, double rate_hz) const override {
    return mode_denominator(effect.value(0), effect.value(1), rate_hz);
  }
  [[nodiscard]] ControlRole body_role(const Effect& effect) const override {
    return control::Mode{effect.value(0), effect.value(1)};
  }
  // Of the first input.
  [[nodiscard]] std::optional<std::complex<double>> path(const SizeCase& at,
                                                         double frequency_hz) const override {
    const Effect& effect = at.effect();
    const double rate_hz = at.model.rate_hz;
    return difference_polynomial_at({effect.coefficients.at(1), effect.coefficients.at(0)},
                                    frequency_hz, rate_hz) /
           polynomial_at(mode_denominator(effect.value(0), effect.value(1), rate_hz), frequency_hz,
                         rate_hz);
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const double at_hz = at.effect().value(0);
    return {{"magnitude", unit_over(at.model.output_unit, at.signals.inputs().front().unit),
             std::abs(*path(at, at_hz)), "of the mode's own response, at its frequency", at_hz}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "a mode at " + with_unit(effect.value(0), "Hz") + " with damping ratio " +
           with_unit(effect.value(1), "") + " in addition to those of the body";
  }
};

Effect mode_beside(const Screening& screening, double frequency_hz, double damping_ratio) {
  return {"resonance",
          "beside the body",
          {},
          {{"frequency", "Hz", frequency_hz, 0.5 * kLowest_hz,
            kHighestModeOfRate * screening.signals().rate_hz()},
           {"damping_ratio", "-", damping_ratio, kLeastDamping, kLargestDamping}},
          {}};
}

// The mode of a larger body that is best taken out of it: the rest must be a body as the model
// allows it, and the mode itself explain least.
std::optional<Proposal> mode_of(const Model& larger, const Screening& screening, double gain) {
  const Signals& signals = screening.signals();
  std::optional<Proposal> best;
  double least = 0.0;
  for (SplitBody& split : split_modes(larger.body, signals.rate_hz())) {
    Effect effect = mode_beside(screening, split.frequency_hz, split.damping_ratio);
    const bool within = std::ranges::all_of(effect.parameters, [](const Parameter& each) {
      return each.value >= each.lower && each.value <= each.upper;
    });
    split.rest.largest_radius = screening.model().body.largest_radius;
    split.rest.slowest_radius = screening.model().body.slowest_radius;
    if (!within || !is_stable(split.rest)) continue;
    // c_0 x(n) + c_1 x(n-1) by the difference of x and by x.
    for (const auto& [c0, c1] : split.mode) {
      effect.coefficients.push_back(-c1);
      effect.coefficients.push_back(c0 + c1);
    }
    Columns columns;
    effect_kind(effect.kind).terms(effect, signals, {}, columns);
    double power = 0.0;
    for (std::size_t n = 0; n < signals.size(); ++n) {
      double sum = 0.0;
      for (std::size_t c = 0; c < columns.size(); ++c)
        sum += effect.coefficients[c] * columns[c][n];
      power += sum * sum;
    }
    if (best && power >= least) continue;
    least = power;
    best = Proposal{std::move(effect), gain, std::move(split.rest)};
  }
  return best;
}

// Bodies with two more poles, fitted from starts of their own: a grid of modes next to the present
// body misses a mode that needs a different body.
std::vector<Proposal> from_larger_bodies(const Screening& screening) {
  constexpr int kIterations = 15;
  if (auto known = screening.known("resonance"); !known.empty()) return known;
  const Signals& signals = screening.signals();
  const Model& own = screening.model();
  const int order = static_cast<int>(own.body.order()) + 2;
  std::vector<double> left = signals.output().values;
  std::vector<std::vector<double>> inputs;
  const bool bound_to_order = std::ranges::any_of(own.effects, [](const Effect& effect) {
    return effect_kind(effect.kind).through_body(effect);
  });
  if (order > kLargestOrder || bound_to_order || !without_effects(own, signals, inputs, left)) {
    return {};
  }
  const Body other = order == 6 ? with_other_mode(own.body, inputs, left, signals) : own.body;
  std::vector<Proposal> proposals;
  for (Body& start : std::vector<Body>{
           with_mode(other, other.denominator, inputs, left, signals),
           started_body(inputs, left,
                        own.effects.empty() ? screening.impulse_response() : ImpulseResponse{},
                        signals, order)}) {
    Model larger = own;
    larger.body = std::move(start);
    // Beside the body a mode may ring longer than the body's poles, whose free response is fitted.
    larger.body.largest_radius =
        std::exp(-1.0 / (kLongestRinging * signals.duration_s() * signals.rate_hz()));
    larger.body.slowest_radius = larger.body.largest_radius;
    FitOptions options;
    options.max_iterations = kIterations;
    const FitResult fitted = fit(larger, signals, screening.blocks(), options);
    auto proposal = mode_of(larger, screening, 1.0 - std::pow(fitted.rmse / screening.rmse(), 2));
    if (proposal) proposals.push_back(std::move(*proposal));
  }
  return best_of(std::move(proposals), 1);
}

std::vector<Proposal> Resonance::proposed(const Screening& screening) const {
  if (screening.model().body.order() == 0) return {};
  const double highest_hz = kHighestModeOfRate * screening.signals().rate_hz();
  std::vector<Proposal> proposals;
  for (const double damping : kTriedDamping) {
    const double ratio = 1.0 + kStep * damping;
    const auto steps = static_cast<int>(std::log(highest_hz / kLowest_hz) / std::log(ratio));
    for (int i = 0; i <= steps; ++i) {
      const double frequency_hz = kLowest_hz * std::pow(ratio, i);
      proposals.push_back(
          screening.with_coefficients(mode_beside(screening, frequency_hz, damping)));
    }
  }
  proposals = best_of(std::move(proposals), 1);
  append(proposals, from_larger_bodies(screening));
  return proposals;
}

}  // namespace

const EffectKind& resonance_kind() {
  static const Resonance kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

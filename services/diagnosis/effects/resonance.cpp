// SPDX-License-Identifier: Apache-2.0
#include "diagnosis/effects/resonance.hpp"

#include <cmath>
#include <numbers>

#include "diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kTriedDamping[] = {0.03, 0.1, 0.3};
constexpr int kTriedFrequencies = 24;
constexpr double kLowest_hz = 0.3;
constexpr double kHighestOfRate = 0.4;

// Poles of a mode by the matched z transform, over which the input is passed.
std::vector<double> mode_denominator(double frequency_hz, double damping, double rate_hz) {
  const double w = 2.0 * std::numbers::pi * frequency_hz / rate_hz;
  const double radius = std::exp(-damping * w);
  const double angle = w * std::sqrt(std::max(1.0 - damping * damping, 0.0));
  return {1.0, -2.0 * radius * std::cos(angle), radius * radius};
}

class Resonance final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "resonance"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const auto denominator = mode_denominator(effect.value(0), effect.value(1), signals.rate_hz());
    std::vector<double> x =
        through_poles(signals.inputs().front().values, denominator, signals.stretches());
    columns.push_back(differenced(x, signals.stretches()));
    columns.push_back(std::move(x));
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "a mode at " + with_unit(effect.value(0), "Hz") + " with damping ratio " +
           with_unit(effect.value(1), "") + " that the body's order leaves no room for";
  }
};

std::vector<Proposal> Resonance::proposed(const Screening& screening) const {
  if (screening.model().body.order() == 0) return {};
  const double highest_hz = kHighestOfRate * screening.signals().rate_hz();
  std::vector<Proposal> proposals;
  for (int i = 0; i < kTriedFrequencies; ++i) {
    const double frequency_hz =
        kLowest_hz *
        std::pow(highest_hz / kLowest_hz, static_cast<double>(i) / (kTriedFrequencies - 1));
    for (const double damping : kTriedDamping) {
      auto [effect, gain] = screening.with_coefficients(
          {"resonance",
           "beside the body",
           {},
           {{"frequency", "Hz", frequency_hz, 0.5 * kLowest_hz, highest_hz},
            {"damping_ratio", "-", damping, 0.003, 0.95}},
           {}});
      proposals.push_back({std::move(effect), gain, {}});
    }
  }
  return best_of(std::move(proposals), 1);
}

}  // namespace

const EffectKind& resonance_kind() {
  static const Resonance kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

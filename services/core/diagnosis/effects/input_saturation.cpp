// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

// [standard deviations]
const std::vector<double> kTriedLimits{0.3, 0.5, 0.7, 0.9, 1.1, 1.4, 1.7, 2.0, 2.5};

double limited(double u, double limit, bool softly) {
  return softly ? limit * std::tanh(u / limit) : std::clamp(u, -limit, limit);
}

/// An input that reaches the body only up to a limit L:
///
///   clip(u_1, L)  or  L tanh(u_1 / L)
///
/// Source: METHOD Eq. DG-29; a static map before a linear system: Schoukens and Ljung (2019).
class InputSaturation final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "input_saturation"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kInputValue; }
  [[nodiscard]] double mapped(const Effect& effect, double u) const override {
    return limited(u, effect.value(0), is_soft(effect));
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const double rate_hz = at.model.rate_hz;
    const auto gain = polynomial_at(at.model.body.numerators.front(), 0.0, rate_hz) /
                      polynomial_at(at.model.body.denominator, 0.0, rate_hz);
    return {{"limit_force", at.model.output_unit, std::abs(gain) * at.effect().value(0),
             "of the body at the limit, at 0 Hz"}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return effect.channels.front() + " acts only up to +-" +
           with_unit(effect.value(0), effect.parameters[0].unit) + ", " + effect.form;
  }
};

std::vector<Proposal> InputSaturation::proposed(const Screening& screening) const {
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  const Signal& input = screening.signals().inputs().front();
  double largest = 0.0;
  for (const double u : input.values) largest = std::max(largest, std::abs(u));
  std::vector<double> limits;
  for (const double limit : kTriedLimits) limits.push_back(limit * input.deviation);
  std::vector<Proposal> all;
  for (const char* form : {"hard", "soft"}) {
    const bool softly = form[0] == 's';
    for (Proposal& each : input_map_proposals(
             screening,
             {"input_saturation",
              form,
              {input.name},
              {{"limit", input.unit, 0.0, 0.02 * input.deviation,
                softly ? 5.0 * largest : largest}},
              {}},
             limits, [softly](double u, double limit) { return limited(u, limit, softly) - u; })) {
      all.push_back(std::move(each));
    }
  }
  return all;
}

}  // namespace

const EffectKind& input_saturation_kind() {
  static const InputSaturation kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

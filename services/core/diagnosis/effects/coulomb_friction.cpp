// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

// Mean of sign(v) over half a sample before and after, v on straight lines between the samples:
// where the rate crosses zero inside, a share of both signs.
double sign_over(double from, double to) {
  if (from * to >= 0.0) return from + to > 0.0 ? 1.0 : (from + to < 0.0 ? -1.0 : 0.0);
  const double share = (std::abs(to) - std::abs(from)) / (std::abs(to) + std::abs(from));
  return to > 0.0 ? share : -share;
}

std::vector<double> signs(const std::vector<double>& v, const std::vector<Stretch>& stretches) {
  std::vector<double> s(v.size());
  for (const Stretch& stretch : stretches) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      const double before = n > stretch.first ? 0.5 * (v[n - 1] + v[n]) : v[n];
      const double after = n + 1 < stretch.end ? 0.5 * (v[n] + v[n + 1]) : v[n];
      s[n] = 0.5 * (sign_over(before, v[n]) + sign_over(v[n], after));
    }
  }
  return s;
}

/// A force with the sign of a rate:
///
///   c sign(v)  or  c tanh(v / v_t)
///
/// Source: METHOD Eq. DG-23; Worden and Tomlinson (2001).
class CoulombFriction final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "coulomb_friction"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& rate = signals.at(effect.channels.at(0));
    if (effect.parameters.empty()) {
      columns.push_back(signs(rate.values, signals.stretches()));
      return;
    }
    columns.push_back(rate.values);
    for (double& v : columns.back()) v = std::tanh(v / effect.value(0));
  }
  [[nodiscard]] ControlRole drive_role(const Effect& effect) const override {
    return control::Friction{effect.parameters.empty() ? 0.0 : effect.value(0)};
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const double force = through_body(at.effect()) ? through_body_at(at, 0.0).real()
                                                   : at.effect().coefficients.at(0);
    return {{"friction_force", at.model.output_unit, std::abs(force),
             std::string(force < 0.0 ? "against" : "along") + " the sign of " +
                 at.effect().channels.at(0) +
                 (through_body(at.effect()) ? ", at 0 Hz behind the body" : "")}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "a force of " + with_unit(std::abs(effect.coefficients.at(0)), "(output unit)") +
           (effect.coefficients.at(0) < 0.0 ? " against" : " along") + " the sign of " +
           effect.channels.at(0) + ", " + effect.form;
  }
};

std::vector<Proposal> CoulombFriction::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> proposals;
  for (const Signal& signal : signals.all()) {
    if (signal.quantity != Quantity::kRate) continue;
    // A rate that never changes its sign has friction like an offset.
    const auto negative =
        static_cast<double>(std::ranges::count_if(signal.values, [](double v) { return v < 0.0; }));
    const double share = negative / static_cast<double>(signals.size());
    if (share < 0.02 || share > 0.98) continue;
    std::vector<Effect> forms{{"coulomb_friction", "sign, beside the body", {signal.name}, {}, {}},
                              {"coulomb_friction",
                               "smooth sign, beside the body",
                               {signal.name},
                               {{"transition_rate", signal.unit, 0.15 * signal.deviation,
                                 1e-3 * signal.deviation, 0.6 * signal.deviation}},
                               {}}};
    if (screening.model().body.order() > 0) {
      forms.push_back({"coulomb_friction", "sign, through the body", {signal.name}, {}, {}});
    }
    for (Effect& form : forms) {
      proposals.push_back(screening.with_coefficients(std::move(form)));
    }
  }
  return best_of(std::move(proposals), 3);
}

}  // namespace

const EffectKind& coulomb_friction_kind() {
  static const CoulombFriction kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/loop_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/loop_sizes.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kTriedThresholds[] = {0.2, 0.5, 1.0};  // [standard deviations]

bool smooth(const Effect& effect) { return effect.form.starts_with("smooth"); }

signal::HysteresisOperator operator_of(const Effect& effect) {
  return smooth(effect) ? signal::HysteresisOperator::kDahl : signal::HysteresisOperator::kStop;
}

Nonlinearity element_of(const Effect& effect, double threshold) {
  return {signal::step_of(operator_of(effect)), threshold};
}

/// A force that depends on the past of a displacement z, in units of a threshold:
///
///   w(n) = clip(w(n-1) + z(n) - z(n-1), 1)  or  dw = dz (1 - w sign dz)
///
/// Source: METHOD Eq. DG-26; Visintin (1994) for the first, Dahl (1968) for the second.
class Hysteresis final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "hysteresis"; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    return effect.channels.empty() ? Stage::kFeedback : Stage::kTerm;
  }
  [[nodiscard]] Nonlinearity feedback(const Effect& effect) const override {
    return element_of(effect, threshold_of(effect));
  }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& position = signals.at(effect.channels.at(0));
    std::vector<double> state(signals.size());
    std::vector<double> linear(signals.size());
    const Nonlinearity element = element_of(effect, effect.value(0));
    for (const Stretch& stretch : signals.stretches()) {
      LoopMemory memory;
      for (std::size_t n = stretch.first; n < stretch.end; ++n) {
        state[n] = element.phi(position.values[n] / element.threshold, memory);
        linear[n] = position.values[n];
      }
    }
    columns.push_back(std::move(state));
    if (!signals.is_input(effect.channels[0])) columns.push_back(std::move(linear));
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t i) const override {
    return i == 0 ? "-" : signals.at(effect.channels.at(0)).unit;
  }
  [[nodiscard]] ControlRole body_role(const Effect& effect) const override {
    if (effect.channels.empty()) return control::Spring{operator_of(effect)};
    return control::Hysteresis{operator_of(effect), effect.value(0)};
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override;
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    const std::string element =
        smooth(effect) ? "Dahl's state" : "an elastic, perfectly plastic state";
    if (effect.channels.empty())
      return "the response depends on its past: " + element + ", " + effect.form;
    return "the residual follows " + element + " of " + effect.channels.front() +
           ", yielding after " + with_unit(effect.value(0), effect.parameters[0].unit);
  }
};

std::vector<Size> Hysteresis::sizes(const SizeCase& at) const {
  const Effect& effect = at.effect();
  const std::string yielding = "half the height of the loop";
  if (stage(effect) == Stage::kFeedback) {
    return {
        {"yield_force", at.model.output_unit, std::abs(output_over_phi(at)),
         yielding + " at the output, at 0 Hz"},
        force_at_threshold(at, "slip_force", 1.0, "amplitude of the output from which it slips"),
        stiffness_ratio(at, 0.0, 1.0, "where it slips, over that where it sticks")};
  }
  const Signal& position = at.signals.at(effect.channels.at(0));
  const double force = effect.coefficients.at(0);
  return {{"yield_force", at.model.output_unit, std::abs(force), yielding},
          {"slip_distance", position.unit, effect.value(0),
           "from rest until it slips; twice as far after a turn"},
          {"sticking_stiffness", unit_over(at.model.output_unit, position.unit),
           force / effect.value(0), "that slipping takes away"}};
}

std::vector<Proposal> Hysteresis::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  std::vector<Proposal> proposals;
  append(proposals,
         loop_proposals(screening, "hysteresis", "elastic-plastic", signal::stop_operator, false));
  append(proposals,
         loop_proposals(screening, "hysteresis", "smooth", signal::dahl_operator, false));
  std::vector<Proposal> of_channels;
  for (const Signal& signal : signals.all()) {
    if (signal.quantity != Quantity::kPosition) continue;
    for (const char* form : {"elastic-plastic, beside the body", "smooth, beside the body"}) {
      for (const double threshold : kTriedThresholds) {
        of_channels.push_back(
            screening.with_coefficients({"hysteresis",
                                         form,
                                         {signal.name},
                                         {{"threshold", signal.unit, threshold * signal.deviation,
                                           1e-3 * signal.deviation, 5.0 * signal.deviation}},
                                         {}}));
      }
    }
  }
  append(proposals, best_of(std::move(of_channels), 1));
  return best_of(std::move(proposals), 4);
}

}  // namespace

const EffectKind& hysteresis_kind() {
  static const Hysteresis kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

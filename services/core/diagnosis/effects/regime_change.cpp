// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr int kCoarse = 40;     // moments tried over the record
constexpr int kFine = 20;       // and around the best of them
constexpr double kEdge = 0.05;  // of the record, at both ends: too short to determine a gain
constexpr double kLargestStep = 5.0;

/// A gain of the body's output that changes at one moment t_0:
///
///   g = 1 - c before t_0, 1 + c after
///
/// Source: METHOD Eq. DG-34.
class RegimeChange final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "regime_change"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kGain; }
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  void gain(const Effect& effect, const Signals& signals, std::span<double> gain) const override {
    for (std::size_t n = 0; n < gain.size(); ++n) {
      const double t_s = signals.time_s()[n] - signals.time_s().front();
      gain[n] *= 1.0 + (t_s < effect.value(0) ? -effect.value(1) : effect.value(1));
    }
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const double change = at.effect().value(1);
    return {{"gain_ratio", "-", (1.0 + change) / (1.0 - change), "after the change over before"}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "the gain changes by a factor of " +
           with_unit((1.0 + effect.value(1)) / (1.0 - effect.value(1)), "") + " at " +
           with_unit(effect.value(0), "s");
  }
};

std::vector<Proposal> RegimeChange::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  const double length_s = signals.duration_s();
  const auto tried = [&](double at_s) {
    std::vector<double> column = screening.body_output();
    for (std::size_t n = 0; n < column.size(); ++n) {
      if (signals.time_s()[n] - signals.time_s().front() < at_s) column[n] = -column[n];
    }
    const ScreenedGain found = screening.gain({column});
    return Proposal{{"regime_change",
                     "step of the gain",
                     {},
                     {{"time", "s", at_s, 0.0, length_s, false},
                      {"change", "-", std::clamp(found.coefficients[0], -0.9, 0.9), -kLargestStep,
                       kLargestStep}},
                     {}},
                    found.share,
                    {}};
  };
  std::vector<Proposal> proposals;
  const double step_s = (1.0 - 2.0 * kEdge) * length_s / kCoarse;
  for (int i = 0; i <= kCoarse; ++i) proposals.push_back(tried(kEdge * length_s + i * step_s));
  proposals = best_of(std::move(proposals), 1);
  const double best_s = proposals.front().effect.value(0);
  for (int i = -kFine; i <= kFine; ++i) {
    proposals.push_back(tried(std::clamp(best_s + i * step_s / kFine, 0.0, length_s)));
  }
  return best_of(std::move(proposals), 1);
}

}  // namespace

const EffectKind& regime_change_kind() {
  static const RegimeChange kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

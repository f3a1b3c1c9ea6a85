// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/fitting/line_search.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kFewestPeriods = 5.0;  // less is drift
constexpr double kHighestToneOfRate = 0.48;
constexpr std::size_t kLines = 3;
// Of a line's power over its surroundings' median: noise of any smooth spectrum exceeds it in one
// record of thousands, exp(-25 ln 2) a line.
constexpr double kLeastProminence = 25.0;

/// A sinusoid in time that no channel has:
///
///   c sin(2 pi f t) + c' cos(2 pi f t)
///
/// Source: METHOD Eq. DG-31.
class Tone final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "tone"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    std::vector<double> sine(signals.size());
    std::vector<double> cosine(signals.size());
    for (std::size_t n = 0; n < sine.size(); ++n) {
      const double turn = 2.0 * std::numbers::pi * signals.time_s()[n] * effect.value(0);
      sine[n] = std::sin(turn);
      cosine[n] = std::cos(turn);
    }
    columns.push_back(std::move(sine));
    columns.push_back(std::move(cosine));
  }
  [[nodiscard]] ControlRole body_role(const Effect& effect) const override {
    return control::Waves{effect.value(0)};
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    return {{"amplitude", at.model.output_unit,
             std::hypot(at.effect().coefficients.at(0), at.effect().coefficients.at(1))}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override {
    const Signals& signals = screening.signals();
    const Eigen::VectorXd& r = screening.residual();
    const double line_hz = 1.0 / signals.duration_s();
    std::vector<Proposal> proposals;
    for (const Line& line : strongest_lines(signals.time_s(), {r.data(), r.data() + r.size()},
                                            kFewestPeriods * line_hz,
                                            kHighestToneOfRate * signals.rate_hz(), kLines)) {
      if (line.prominence < kLeastProminence) continue;
      proposals.push_back(screening.with_coefficients(
          {"tone",
           "beside the body",
           {},
           {{"frequency", "Hz", line.frequency, line.frequency - 0.5 * line_hz,
             line.frequency + 0.5 * line_hz}},
           {}}));
    }
    return best_of(std::move(proposals), 1);
  }
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "a line at " + with_unit(effect.value(0), "Hz") + " with amplitude " +
           with_unit(std::hypot(effect.coefficients.at(0), effect.coefficients.at(1)),
                     "(output unit)") +
           " that no channel has";
  }
};

}  // namespace

const EffectKind& tone_kind() {
  static const Tone kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

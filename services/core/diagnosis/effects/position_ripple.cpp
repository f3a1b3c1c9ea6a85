// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/fitting/line_search.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kFewestPeriods = 1.5;  // within the range of the position
constexpr double kMostPeriods = 4000.0;
constexpr double kSamplesPerPeriod = 3.0;  // at the median speed
constexpr std::size_t kLines = 4;

int harmonics_of(const Effect& effect) { return effect.form == "two harmonics" ? 2 : 1; }

/// A force periodic in a position x, of spatial frequency k, with one or two harmonics (cogging):
///
///   sum_h c_h sin(2 pi h k x) + c'_h cos(2 pi h k x)
///
/// Source: METHOD Eq. DG-30.
class PositionRipple final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "position_ripple"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    const Signal& position = signals.at(effect.channels.at(0));
    for (int h = 1; h <= harmonics_of(effect); ++h) {
      std::vector<double> sine(signals.size());
      std::vector<double> cosine(signals.size());
      for (std::size_t n = 0; n < sine.size(); ++n) {
        const double turn = 2.0 * std::numbers::pi * h * position.values[n] * effect.value(0);
        sine[n] = std::sin(turn);
        cosine[n] = std::cos(turn);
      }
      columns.push_back(std::move(sine));
      columns.push_back(std::move(cosine));
    }
  }
  // A position summed up from a rate begins anywhere: the ripple's phase is the recording's own.
  [[nodiscard]] bool time_only(const Effect& effect) const override {
    return effect.channels.at(0).starts_with("position of ");
  }
  [[nodiscard]] ControlRole drive_role(const Effect& effect) const override {
    return control::Waves{effect.value(0)};
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const Effect& effect = at.effect();
    std::vector<Size> sizes;
    for (std::size_t h = 0; 2 * h + 1 < effect.coefficients.size(); ++h) {
      sizes.push_back({h == 0 ? "amplitude" : "amplitude_" + std::to_string(h + 1),
                       at.model.output_unit,
                       std::hypot(effect.coefficients[2 * h], effect.coefficients[2 * h + 1]),
                       "of harmonic " + std::to_string(h + 1)});
    }
    sizes.push_back({"period", period_unit(effect), 1.0 / effect.value(0)});
    return sizes;
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "the residual repeats every " + with_unit(1.0 / effect.value(0), period_unit(effect)) +
           " of " + effect.channels.at(0) + ", amplitude " +
           with_unit(std::hypot(effect.coefficients.at(0), effect.coefficients.at(1)),
                     "(output unit)");
  }

 private:
  static std::string period_unit(const Effect& effect) {
    return effect.parameters[0].unit.substr(2);  // behind "1/"
  }
};

// Within the resolution of the range one would make up for the other.
bool shares_a_harmonic(const Effect& one, const Effect& other, double range) {
  for (int i = 1; i <= harmonics_of(one); ++i) {
    for (int k = 1; k <= harmonics_of(other); ++k) {
      if (std::abs(i * one.value(0) - k * other.value(0)) < 1.0 / range) return true;
    }
  }
  return false;
}

std::vector<Proposal> PositionRipple::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  const Eigen::VectorXd& r = screening.residual();
  const std::vector<double> residual(r.data(), r.data() + r.size());
  std::vector<Proposal> proposals;
  for (const Signal& signal : signals.all()) {
    if (signal.quantity != Quantity::kPosition) continue;
    const auto [low, high] = std::ranges::minmax(signal.values);
    const double range = high - low;
    std::vector<double> steps;
    for (std::size_t n = 1; n < signal.values.size(); ++n) {
      steps.push_back(std::abs(signal.values[n] - signal.values[n - 1]));
    }
    const double step = signal::middle_of(steps);
    if (!(range > 0.0) || !(step > 0.0)) continue;
    const double highest = std::min(kMostPeriods / range, 1.0 / (kSamplesPerPeriod * step));
    for (const Line& line :
         strongest_lines(signal.values, residual, kFewestPeriods / range, highest, kLines)) {
      const auto propose = [&](const char* form, double frequency) {
        const Effect ripple{"position_ripple",
                            form,
                            {signal.name},
                            {{"spatial_frequency", "1/" + signal.unit, frequency,
                              frequency - 0.5 / range, frequency + 0.5 / range}},
                            {}};
        const bool known = std::ranges::any_of(screening.model().effects, [&](const Effect& each) {
          return each.kind == ripple.kind && each.channels == ripple.channels &&
                 shares_a_harmonic(each, ripple, range);
        });
        if (known) return;
        proposals.push_back(screening.with_coefficients(ripple));
      };
      propose("one harmonic", line.frequency);
      // The strongest line may be the first harmonic or the second.
      propose("two harmonics", line.frequency);
      if (0.5 * line.frequency > 0.8 / range) propose("two harmonics", 0.5 * line.frequency);
    }
  }
  return best_of(std::move(proposals), 3);
}

}  // namespace

const EffectKind& position_ripple_kind() {
  static const PositionRipple kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

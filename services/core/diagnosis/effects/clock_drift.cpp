// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/interpolation.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLargestDrift = 0.02;  // [-] crystals: 1e-4; recorders that drop samples: more
// [s] over the record, each way: what a linearisation doesn't reach.
constexpr double kTriedDrifts_s[] = {-0.24, -0.12, -0.06, -0.03, 0.0, 0.03, 0.06, 0.12, 0.24};

/// Clocks of input and output that run apart:
///
///   u(t - d (t - t_m)),  t_m the middle of the record
///
/// Source: METHOD Eq. DG-35, by the fractional delay of DG-2, Laakso et al. (1996).
class ClockDrift final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "clock_drift"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kInputTime; }
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  [[nodiscard]] double input_delay_s(const Effect& effect, double time_s) const override {
    return 1e-6 * effect.value(0) * (time_s - effect.value(1));
  }
  [[nodiscard]] ControlRole body_role(const Effect& /*effect*/) const override {
    return control::LeftOut{"input and output run on two clocks, the canceller on one"};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    return "the output lags the input by " + with_unit(effect.value(0), "us") +
           " more every second";
  }
};

std::vector<Proposal> ClockDrift::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  const double middle_s = signals.time_s().front() + 0.5 * signals.duration_s();
  const double length_s = std::max(signals.duration_s(), 1e-9);
  std::vector<Proposal> proposals;
  const Body& body = screening.model().body;
  for (const double over_record_s : kTriedDrifts_s) {
    const double start = over_record_s / length_s;
    if (std::abs(start) > kLargestDrift) continue;
    // The body's zeros are free to follow, its poles are taken as they are.
    const auto at = [&](double drift) {
      Columns columns;
      for (const Signal& input : signals.inputs()) {
        const auto moved =
            delayed(input.values, signals, [&](double t_s) { return drift * (t_s - middle_s); });
        for (auto& each : screening.through_body(moved)) columns.push_back(std::move(each));
      }
      return columns;
    };
    Columns columns = at(start);
    // Its derivative with respect to the drift lets the linear solution move it.
    constexpr double kStep = 1e-6;
    Columns moved = at(start + kStep);
    std::vector<double> slope(signals.size(), 0.0);
    std::size_t next = 0;
    for (std::size_t k = 0; k < signals.inputs().size(); ++k) {
      for (const double c : difference_basis(body.numerators[k])) {
        for (std::size_t n = 0; n < slope.size(); ++n) {
          slope[n] += c * (moved[next][n] - columns[next][n]) / kStep;
        }
        ++next;
      }
    }
    columns.push_back(std::move(slope));
    const ScreenedGain found = screening.gain(columns);
    const double drift =
        std::clamp(start + found.coefficients.back(), -kLargestDrift, kLargestDrift);
    Proposal proposal{{"clock_drift",
                       "of the output",
                       {},
                       {{"drift", "us/s", 1e6 * drift, -1e6 * kLargestDrift, 1e6 * kLargestDrift},
                        constant("reference_time", "s", middle_s)},
                       {}},
                      found.share,
                      {}};
    proposals.push_back(std::move(proposal));
  }
  return best_of(std::move(proposals), 1);
}

}  // namespace

const EffectKind& clock_drift_kind() {
  static const ClockDrift kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

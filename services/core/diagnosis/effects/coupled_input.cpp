// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"
#include "services/core/diagnosis/model/steady_start.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kStartLag_s[] = {0.05, 0.2, 0.8, 3.0, 10.0};
constexpr double kLongestLag = 0.2;   // [record lengths]
constexpr double kLeastPassed = 0.1;  // of the channel's deviation

// From these levels on; on the first value alone, of a signal that swings, it would fade like a
// drift.
std::vector<double> low_passed(const Signal& signal, double lag_s, const Signals& signals,
                               const std::vector<double>& levels) {
  const double keep = std::exp(-1.0 / (lag_s * signals.rate_hz()));
  std::vector<double> y(signal.values.size());
  for (std::size_t s = 0; s < levels.size(); ++s) {
    const Stretch& stretch = signals.stretches()[s];
    double state = levels[s];
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      state += (1.0 - keep) * (signal.values[n] - state);
      y[n] = state;
    }
  }
  return y;
}

// METHOD Eq. DG-55: behind a longer lag little is left of the channel but its start and its slowest
// part, which would imitate a drift.
double longest_lag_s(const Signal& signal, const Signals& signals) {
  const std::vector<double> means(signals.stretches().size(), signal.mean);
  const double most_s = kLongestLag * signals.duration_s();
  double lag_s = kStartLag_s[0];
  while (2.0 * lag_s <= most_s && deviation_of(low_passed(signal, 2.0 * lag_s, signals, means)) >=
                                      kLeastPassed * signal.deviation) {
    lag_s *= 2.0;
  }
  return std::min(lag_s, most_s);
}

bool lagged(const Effect& effect) { return effect.form == "lagged"; }

/// A linear path from another channel:
///
///   c x;  c_1 x + c_2 x';  c times a first-order low-pass of x;  x through the body's poles
///
/// Source: METHOD Eq. DG-22.
class CoupledInput final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "coupled_input"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kTerm; }
  void terms(const Effect& effect, const Signals& signals,
             const std::vector<double>& /*body_output*/, Columns& columns) const override {
    for (const std::string& channel : effect.channels) {
      const Signal& signal = signals.at(channel);
      if (lagged(effect)) {
        columns.push_back(
            low_passed(signal, effect.value(0), signals, start_levels(signal.values, signals)));
        continue;
      }
      columns.push_back(signal.values);
    }
  }
  [[nodiscard]] std::string column_unit(const Effect& effect, const Signals& signals,
                                        std::size_t i) const override {
    return signals.at(effect.channels.at(std::min(i, effect.channels.size() - 1))).unit;
  }
  [[nodiscard]] ControlRole body_role(const Effect& effect) const override {
    return control::Path{through_body(effect), lagged(effect) ? effect.value(0) : 0.0};
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override;
  [[nodiscard]] std::optional<std::complex<double>> path(const SizeCase& at,
                                                         double frequency_hz) const override;
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    const std::string& channel = effect.channels.front();
    if (effect.form == "static") {
      return "the residual follows " + channel + " with a gain of " +
             with_unit(effect.coefficients.at(0), "(output unit per channel unit)");
    }
    return "the residual follows " + channel + ", path " + effect.form;
  }
};

// The lag as low_passed() has it.
std::optional<std::complex<double>> CoupledInput::path(const SizeCase& at,
                                                       double frequency_hz) const {
  const Effect& effect = at.effect();
  const double rate_hz = at.model.rate_hz;
  if (through_body(effect)) return through_body_at(at, frequency_hz);
  std::complex<double> response = effect.coefficients.at(0);
  if (lagged(effect)) {
    const double keep = std::exp(-1.0 / (effect.value(0) * rate_hz));
    response *= (1.0 - keep) / polynomial_at({1.0, -keep}, frequency_hz, rate_hz);
  }
  if (effect.channels.size() > 1) {
    response += std::complex<double>(0.0, 2.0 * std::numbers::pi * frequency_hz) *
                effect.coefficients.at(1);
  }
  return response;
}

std::vector<Size> CoupledInput::sizes(const SizeCase& at) const {
  const Effect& effect = at.effect();
  const std::string& channel_unit = at.signals.at(effect.channels.at(0)).unit;
  const std::string unit = unit_over(at.model.output_unit, channel_unit);
  const double gain = path(at, 0.0)->real();
  std::vector<Size> sizes{{"gain", unit, gain, "at 0 Hz"}};
  if (channel_unit == "rad" || channel_unit == "rad/s") {
    const double degree = std::numbers::pi / 180.0;
    sizes.push_back({"gain_per_degree",
                     unit_over(at.model.output_unit, "deg" + channel_unit.substr(3)), gain * degree,
                     "at 0 Hz"});
  }
  if (effect.form != "static") {
    sizes.push_back(
        {"magnitude", unit, std::abs(*path(at, at.centre_hz)), "of the response", at.centre_hz});
  }
  return sizes;
}

std::vector<Proposal> CoupledInput::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  const bool dynamic = screening.model().body.order() > 0;
  std::vector<Proposal> all;
  for (const Signal& signal : signals.all()) {
    if (signals.is_input(signal.source)) continue;
    // Of derived signals a rate is offered alone, too: damping.
    std::vector<Effect> forms;
    if (!signal.derived) {
      forms.push_back({"coupled_input", "static", {signal.name}, {}, {}});
      const double longest_s = longest_lag_s(signal, signals);
      for (const double lag_s : kStartLag_s) {
        if (lag_s > longest_s) break;
        forms.push_back({"coupled_input",
                         "lagged",
                         {signal.name},
                         {{"lag", "s", lag_s, 0.5 / signals.rate_hz(), longest_s}},
                         {}});
      }
      if (dynamic) forms.push_back({"coupled_input", "through the body", {signal.name}, {}, {}});
      if (const Signal* rate = signals.rate_of(signal); rate != nullptr && rate != &signal) {
        forms.push_back({"coupled_input", "static with rate", {signal.name, rate->name}, {}, {}});
      }
    } else if (signal.quantity == Quantity::kRate && signal.name.starts_with("rate of")) {
      forms.push_back({"coupled_input", "static", {signal.name}, {}, {}});
    }
    std::vector<Proposal> proposals;
    for (Effect& form : forms) {
      proposals.push_back(screening.with_coefficients(std::move(form)));
    }
    // The simplest form as well as the best: the joint fits decide.
    if (proposals.empty()) continue;
    all.push_back(proposals.front());
    for (Proposal& each : best_of(std::move(proposals), 1)) {
      if (each.effect.form != "static") all.push_back(std::move(each));
    }
  }
  return best_of(std::move(all), 4);
}

}  // namespace

const EffectKind& coupled_input_kind() {
  static const CoupledInput kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

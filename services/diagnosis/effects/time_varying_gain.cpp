// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/effects/time_varying_gain.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLargest = 3.0;
constexpr int kCosines = 4;
constexpr double kPeriods[] = {1.0, 1.5, 2.0, 3.0, 4.0, 6.0};  // [cycles a record]

// Shapes, each between -1 and 1; t from 0 to 1 over the record.
double shape(const Effect& effect, std::size_t i, double t) {
  if (effect.form == "linear") return 2.0 * t - 1.0;
  if (effect.form == "sinusoidal") {
    const double turn = 2.0 * std::numbers::pi * effect.value(0) * t;
    return i == 1 ? std::sin(turn) : std::cos(turn);
  }
  return std::cos(std::numbers::pi * static_cast<double>(i + 1) * t);
}

bool is_weight(const Effect& effect, std::size_t i) { return effect.form != "sinusoidal" || i > 0; }

// Gain over the record, over its mean.
struct Swing {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
};

Swing swing_of(const Effect& effect) {
  Swing swing;
  for (int step = 0; step <= 200; ++step) {
    double factor = 1.0;
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      if (is_weight(effect, i)) factor += effect.value(i) * shape(effect, i, step / 200.0);
    }
    swing = {std::min(swing.low, factor), std::max(swing.high, factor)};
  }
  return swing;
}

class TimeVaryingGain final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "time_varying_gain"; }
  [[nodiscard]] double size_found() const override { return 1.5; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kGain; }
  // predict() takes it at its mean, 1.
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  void gain(const Effect& effect, const Signals& signals, std::span<double> gain) const override {
    for (std::size_t n = 0; n < gain.size(); ++n) {
      const double t = (signals.time_s()[n] - signals.time_s().front()) / signals.duration_s();
      double factor = 1.0;
      for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
        if (is_weight(effect, i)) factor += effect.value(i) * shape(effect, i, t);
      }
      gain[n] *= factor;
    }
  }
  [[nodiscard]] std::vector<Size> sizes(const SizeCase& at) const override {
    const Swing swing = swing_of(at.effect());
    return {{"lowest_gain", "-", swing.low, "over its mean"},
            {"highest_gain", "-", swing.high, "over its mean"}};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    const Swing swing = swing_of(effect);
    return "the gain moves slowly between " + with_unit(swing.low, "") + " and " +
           with_unit(swing.high, "") + " of its mean, " + effect.form;
  }
};

std::vector<Proposal> TimeVaryingGain::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  const auto weight = [](const std::string& name) {
    return Parameter{name, "-", 0.0, -kLargest, kLargest};
  };
  std::vector<Effect> forms{{"time_varying_gain", "linear", {}, {weight("change")}, {}},
                            {"time_varying_gain", "slow cosines", {}, {}, {}}};
  for (int k = 1; k <= kCosines; ++k) {
    forms.back().parameters.push_back(weight("half_cosine_" + std::to_string(k)));
  }
  for (const double cycles : kPeriods) {
    forms.push_back(
        {"time_varying_gain",
         "sinusoidal",
         {},
         {{"cycles_per_record", "-", cycles, 0.5, 12.0}, weight("sine"), weight("cosine")},
         {}});
  }
  std::vector<Proposal> proposals;
  for (Effect& form : forms) {
    Columns columns;
    for (std::size_t i = 0; i < form.parameters.size(); ++i) {
      if (!is_weight(form, i)) continue;
      std::vector<double> column = screening.body_output();
      for (std::size_t n = 0; n < column.size(); ++n) {
        const double t = (signals.time_s()[n] - signals.time_s().front()) / signals.duration_s();
        column[n] *= shape(form, i, t);
      }
      columns.push_back(std::move(column));
    }
    const ScreenedGain found = screening.gain(columns);
    std::size_t next = 0;
    for (std::size_t i = 0; i < form.parameters.size(); ++i) {
      if (!is_weight(form, i)) continue;
      form.parameters[i].value = std::clamp(found.coefficients[next++], -kLargest, kLargest);
    }
    proposals.push_back({std::move(form), found.share, {}});
  }
  const Proposal linear = proposals.front();
  proposals = best_of(std::move(proposals), 2);
  if (proposals[0].effect.form != "linear" && proposals[1].effect.form != "linear") {
    proposals.push_back(linear);
  }
  return proposals;
}

}  // namespace

const EffectKind& time_varying_gain_kind() {
  static const TimeVaryingGain kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

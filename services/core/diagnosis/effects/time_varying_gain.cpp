// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kLargestGainChange = 3.0;
constexpr std::size_t kCosines = 4;
constexpr double kPeriods[] = {1.0, 1.5, 2.0, 3.0, 4.0, 6.0};  // [cycles a record]

enum class Form { kLinear, kSlowCosines, kSinusoidal };

Form form_of(const Effect& effect) {
  if (effect.form == "linear") return Form::kLinear;
  return effect.form == "sinusoidal" ? Form::kSinusoidal : Form::kSlowCosines;
}

bool is_weight(const Effect& effect, std::size_t i) { return effect.form != "sinusoidal" || i > 0; }

using Values = std::array<double, kCosines>;  // [parameters]

// Each between -1 and 1; t from 0 to 1 over the record.  Every fit runs this for every sample.
Values shapes(Form form, double cycles, double t) {
  if (form == Form::kLinear) return {2.0 * t - 1.0};
  if (form == Form::kSinusoidal) {
    const double turn = 2.0 * std::numbers::pi * cycles * t;
    return {0.0, std::sin(turn), std::cos(turn)};
  }
  const double first = std::cos(std::numbers::pi * t);
  Values all{first, 2.0 * first * first - 1.0};
  for (std::size_t k = 2; k < all.size(); ++k) all[k] = 2.0 * first * all[k - 1] - all[k - 2];
  return all;
}

double factor_at(const Effect& effect, Form form, double t) {
  const Values all = shapes(form, effect.value(0), t);
  double factor = 1.0;
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    factor += effect.parameters[i].value * all.at(i);  // the cycles' shape is 0
  }
  return factor;
}

// Gain over the record, over its mean.
struct Swing {
  double low = HUGE_VAL;
  double high = -HUGE_VAL;
};

Swing swing_of(const Effect& effect) {
  Swing swing;
  for (int step = 0; step <= 200; ++step) {
    const double factor = factor_at(effect, form_of(effect), step / 200.0);
    swing = {std::min(swing.low, factor), std::max(swing.high, factor)};
  }
  return swing;
}

/// A gain of the body's output that changes slowly over the record's length L:
///
///   g = 1 + c (2 t/L - 1);  1 + sum_{k=1..4} c_k cos(pi k t/L);  1 + s sin + c cos of 2 pi m t/L
///
/// Source: METHOD Eq. DG-33.
class TimeVaryingGain final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "time_varying_gain"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kGain; }
  // predict() takes it at its mean, 1.
  [[nodiscard]] bool time_only(const Effect& /*effect*/) const override { return true; }
  void gain(const Effect& effect, const Signals& signals, std::span<double> gain) const override {
    const Form form = form_of(effect);
    for (std::size_t n = 0; n < gain.size(); ++n) {
      const double t = (signals.time_s()[n] - signals.time_s().front()) / signals.duration_s();
      gain[n] *= factor_at(effect, form, t);
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
    return Parameter{name, "-", 0.0, -kLargestGainChange, kLargestGainChange};
  };
  std::vector<Effect> forms{{"time_varying_gain", "linear", {}, {weight("change")}, {}},
                            {"time_varying_gain", "slow cosines", {}, {}, {}}};
  for (std::size_t k = 1; k <= kCosines; ++k) {
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
        column[n] *= shapes(form_of(form), form.value(0), t)[i];
      }
      columns.push_back(std::move(column));
    }
    const ScreenedGain found = screening.gain(columns);
    std::size_t next = 0;
    for (std::size_t i = 0; i < form.parameters.size(); ++i) {
      if (!is_weight(form, i)) continue;
      form.parameters[i].value =
          std::clamp(found.coefficients[next++], -kLargestGainChange, kLargestGainChange);
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

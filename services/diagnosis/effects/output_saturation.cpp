// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/effects/output_saturation.hpp"

#include <algorithm>
#include <cmath>

#include "services/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

bool soft(const Effect& effect) { return effect.form.starts_with("soft"); }
bool two_limits(const Effect& effect) { return effect.form == "hard, two limits"; }

double upper(const Effect& effect) { return effect.value(0); }
double lower(const Effect& effect) {
  return two_limits(effect) ? effect.value(1) : -effect.value(0);
}

class OutputSaturation final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "output_saturation"; }
  [[nodiscard]] Stage stage(const Effect& /*effect*/) const override { return Stage::kOutputValue; }
  [[nodiscard]] double mapped(const Effect& effect, double y) const override {
    if (!soft(effect)) return std::clamp(y, lower(effect), upper(effect));
    return upper(effect) * std::tanh(y / upper(effect));
  }
  [[nodiscard]] double slope(const Effect& effect, double y) const override {
    if (!soft(effect)) return y > lower(effect) && y < upper(effect) ? 1.0 : 0.0;
    const double t = std::tanh(y / upper(effect));
    return 1.0 - t * t;
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    const std::string& unit = effect.parameters[0].unit;
    return "the output ends at " +
           (two_limits(effect)
                ? with_unit(lower(effect), unit) + " and " + with_unit(upper(effect), unit)
                : "+-" + with_unit(upper(effect), unit)) +
           " while the linear prediction goes on, " + effect.form;
  }
};

// The body of the output as it was before the soft limit; near the limit little of it can be told.
Body body_before(const Effect& effect, const Screening& screening) {
  constexpr double kTellable = 0.97;
  std::vector<double> y = screening.signals().output().values;
  for (double& each : y) {
    each = upper(effect) * std::atanh(std::clamp(each / upper(effect), -kTellable, kTellable));
  }
  return body_anew(screening, measured_inputs(screening), y);
}

std::vector<Proposal> OutputSaturation::proposed(const Screening& screening) const {
  const Signals& signals = screening.signals();
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  const std::vector<double>& y = signals.output().values;
  std::vector<double> size = y;
  for (double& each : size) each = std::abs(each);
  const double largest = quantile_of(size, 1.0);
  const double highest = quantile_of(y, 1.0);
  const double lowest = quantile_of(y, 0.0);
  const std::string& unit = signals.output().unit;
  const auto one_limit = [&](const char* form, double limit) {
    const double least = 0.1 * quantile_of(size, 0.5);
    return Effect{
        "output_saturation", form, {}, {{"limit", unit, limit, least, 3.0 * largest}}, {}};
  };
  std::vector<Effect> starts;
  for (const double limit : {0.97 * largest, quantile_of(size, 0.99), quantile_of(size, 0.95)}) {
    starts.push_back(one_limit("hard", limit));
    starts.push_back(one_limit("soft", 1.5 * limit));
  }
  if (lowest < 0.0 && highest > 0.0) {
    for (const double share : {1.0, 0.95}) {
      const double up = share < 1.0 ? quantile_of(y, share) : 0.97 * highest;
      const double down = share < 1.0 ? quantile_of(y, 1.0 - share) : 0.97 * lowest;
      starts.push_back({"output_saturation",
                        "hard, two limits",
                        {},
                        {{"upper_limit", unit, up, 0.05 * up, 3.0 * largest},
                         {"lower_limit", unit, down, -3.0 * largest, 0.05 * down}},
                        {}});
    }
  }
  // As if the linear body had been fitted to the unlimited output: a start for the joint fit.
  const auto fitted_from = [&](const Effect& start, const Body& body) {
    Model model = screening.model();
    model.body = body;
    model.effects.push_back(start);
    FitOptions options;
    options.max_iterations = 4;
    const FitResult fitted = fit(model, signals, screening.blocks(), options);
    return Proposal{model.effects.back(), 1.0 - std::pow(fitted.rmse / screening.rmse(), 2),
                    model.body};
  };
  const Body& own = screening.model().body;
  const bool first = screening.model().effects.empty();
  std::vector<Proposal> softened;
  for (const Effect& start : starts) {
    if (soft(start)) {
      softened.push_back(fitted_from(start, first ? body_before(start, screening) : own));
    }
  }
  softened = best_of(std::move(softened), 1);
  // The clipped output may have drawn the linear body into a hollow: from the soft limit's, too.
  std::vector<Proposal> hard;
  for (const Effect& start : starts) {
    if (soft(start)) continue;
    hard.push_back(fitted_from(start, own));
    if (!softened.empty()) hard.push_back(fitted_from(start, *softened.front().body));
  }
  std::vector<Proposal> all = best_of(std::move(hard), 2);
  for (Proposal& each : softened) all.push_back(std::move(each));
  return best_of(std::move(all), 3);
}

}  // namespace

const EffectKind& output_saturation_kind() {
  static const OutputSaturation kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

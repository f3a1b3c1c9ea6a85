// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

bool soft(const Effect& effect) { return effect.form.starts_with("soft"); }
bool two_limits(const Effect& effect) { return effect.form == "hard, two limits"; }

double upper(const Effect& effect) { return effect.value(0); }
double lower(const Effect& effect) {
  return two_limits(effect) ? effect.value(1) : -effect.value(0);
}

/// An output that ends at a limit L, or at an upper and a lower one:
///
///   clip(y, L)  or  L tanh(y / L)
///
/// Source: METHOD Eq. DG-28; a static map behind a linear system: Schoukens and Ljung (2019).
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
  [[nodiscard]] ControlRole body_role(const Effect& /*effect*/) const override {
    return control::NotFelt{
        "the limit is the force sensor's and the hand does not feel it: the motor opposes the "
        "force "
        "beyond the limit"};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    const std::string& unit = effect.parameters[0].unit;
    return "the output ends at " +
           (two_limits(effect)
                ? with_unit(lower(effect), unit) + " and " + with_unit(upper(effect), unit)
                : "+-" + with_unit(upper(effect), unit)) +
           " while the linear prediction goes beyond, " + effect.form;
  }
};

// A body fitted to the output before the soft limit.  Near the limit the output determines little.
Body body_before(const Effect& effect, const Screening& screening) {
  constexpr double kTellable = 0.97;
  std::vector<double> y = screening.signals().output().values;
  for (double& each : y) {
    each = upper(effect) * std::atanh(std::clamp(each / upper(effect), -kTellable, kTellable));
  }
  return new_body(screening, measured_inputs(screening), y);
}

std::vector<double> sizes(const std::vector<double>& y) {
  std::vector<double> size = y;
  for (double& each : size) each = std::abs(each);
  return size;
}

// One limit on both sides, hard and soft, near the largest outputs.
std::vector<Effect> symmetric_starts(const Signal& output) {
  const std::vector<double> size = sizes(output.values);
  const double largest = quantile_of(size, 1.0);
  const double least = 0.1 * quantile_of(size, 0.5);
  const auto one_limit = [&](const char* form, double limit) {
    return Effect{
        "output_saturation", form, {}, {{"limit", output.unit, limit, least, 3.0 * largest}}, {}};
  };
  std::vector<Effect> starts;
  for (const double limit : {0.97 * largest, quantile_of(size, 0.99), quantile_of(size, 0.95)}) {
    starts.push_back(one_limit("hard", limit));
    starts.push_back(one_limit("soft", 1.5 * limit));
  }
  return starts;
}

// An upper and a lower limit, for an output of both signs.
std::vector<Effect> two_sided_starts(const Signal& output) {
  const std::vector<double>& y = output.values;
  const double largest = quantile_of(sizes(y), 1.0);
  const double highest = quantile_of(y, 1.0);
  const double lowest = quantile_of(y, 0.0);
  if (!(lowest < 0.0 && highest > 0.0)) return {};
  std::vector<Effect> starts;
  for (const double share : {1.0, 0.95}) {
    const double up = share < 1.0 ? quantile_of(y, share) : 0.97 * highest;
    const double down = share < 1.0 ? quantile_of(y, 1.0 - share) : 0.97 * lowest;
    starts.push_back({"output_saturation",
                      "hard, two limits",
                      {},
                      {{"upper_limit", output.unit, up, 0.05 * up, 3.0 * largest},
                       {"lower_limit", output.unit, down, -3.0 * largest, 0.05 * down}},
                      {}});
  }
  return starts;
}

// A few steps of the joint fit from a start and a body.
Proposal fitted_from(const Effect& start, const Body& body, const Screening& screening) {
  constexpr int kIterations = 4;
  Model model = screening.model();
  model.body = body;
  model.effects.push_back(start);
  FitOptions options;
  options.max_iterations = kIterations;
  const FitResult fitted = fit(model, screening.signals(), screening.blocks(), options);
  return {model.effects.back(), 1.0 - std::pow(fitted.rmse / screening.rmse(), 2), model.body};
}

std::vector<Proposal> OutputSaturation::proposed(const Screening& screening) const {
  for (const Effect& effect : screening.model().effects) {
    if (effect.kind == name()) return {};
  }
  const Signal& output = screening.signals().output();
  std::vector<Effect> starts = symmetric_starts(output);
  for (Effect& each : two_sided_starts(output)) starts.push_back(std::move(each));
  const Body& own = screening.model().body;
  const bool first = screening.model().effects.empty();
  std::vector<Proposal> softened;
  for (const Proposal& each : screening.known(name())) {
    if (soft(each.effect)) softened.push_back(fitted_from(each.effect, *each.body, screening));
  }
  const bool known = !softened.empty();
  for (const Effect& start : starts) {
    if (known || !soft(start)) continue;
    // As if the linear body had been fitted to the output before the limit.
    softened.push_back(fitted_from(start, first ? body_before(start, screening) : own, screening));
  }
  softened = best_of(std::move(softened), 1);
  // The clipped output may hold the linear body in a local minimum: start from the soft limit's
  // too.  Next to other effects both come from the model's own.
  std::vector<Proposal> hard;
  for (const Effect& start : starts) {
    if (soft(start)) continue;
    hard.push_back(fitted_from(start, own, screening));
    if (first && !softened.empty()) {
      hard.push_back(fitted_from(start, *softened.front().body, screening));
    }
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

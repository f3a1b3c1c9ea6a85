// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/effects/kinds.hpp"
#include "services/core/diagnosis/effects/map_proposals.hpp"
#include "services/core/diagnosis/effects/parts.hpp"

namespace stillhand::diagnosis {
namespace {

bool two_limits(const Effect& effect) { return effect.form == "hard, two limits"; }

// Of an output that rests at an end of its range.
bool is_stop(const Effect& effect) { return effect.form.starts_with("stop"); }
bool is_clip(const Effect& effect) { return effect.form.starts_with("clip"); }
bool is_above(const Effect& effect) { return effect.form.ends_with("above"); }

double beyond(double z, LoopMemory& /*memory*/) { return std::max(z, 0.0); }
double short_of(double z, LoopMemory& /*memory*/) { return std::min(z, 0.0); }

double upper(const Effect& effect) {
  return is_clip(effect) && !is_above(effect) ? HUGE_VAL : effect.value(0);
}
double lower(const Effect& effect) {
  if (is_clip(effect)) return is_above(effect) ? -HUGE_VAL : effect.value(0);
  return two_limits(effect) ? effect.value(1) : -effect.value(0);
}

/// An output that ends at a limit L, or at an upper and a lower one:
///
///   clip(y, L)  or  L tanh(y / L)  or  min(y, L)  or  max(y, L)
///
/// or a stop at L, above or below, of the body itself, which so forgets what would go beyond:
///
///   y_b(n) = min(z(n), L),  z(n) = sum b_i u(n-i) - sum a_j y_b(n-j)
///
/// Source: METHOD Eq. DG-28; a static map behind a linear system: Schoukens and Ljung (2019).
class OutputSaturation final : public EffectKind {
 public:
  [[nodiscard]] std::string_view name() const override { return "output_saturation"; }
  [[nodiscard]] Stage stage(const Effect& effect) const override {
    return is_stop(effect) ? Stage::kFeedback : Stage::kOutputValue;
  }
  [[nodiscard]] bool shows_in_rows(const Effect& effect) const override {
    return is_stop(effect) || is_clip(effect);
  }
  [[nodiscard]] Nonlinearity feedback(const Effect& effect) const override {
    if (!is_stop(effect) || effect.parameters.empty()) return EffectKind::feedback(effect);
    return {is_above(effect) ? beyond : short_of, 1.0, effect.value(0)};
  }
  [[nodiscard]] double mapped(const Effect& effect, double y) const override {
    if (!is_soft(effect)) return std::clamp(y, lower(effect), upper(effect));
    return upper(effect) * std::tanh(y / upper(effect));
  }
  [[nodiscard]] double slope(const Effect& effect, double y) const override {
    if (!is_soft(effect)) return y > lower(effect) && y < upper(effect) ? 1.0 : 0.0;
    const double t = std::tanh(y / upper(effect));
    return 1.0 - t * t;
  }
  [[nodiscard]] ControlRole body_role(const Effect& effect) const override {
    if (is_stop(effect)) return control::LeftOut{"the canceller has no stop inside the body"};
    return control::NotFelt{
        "the limit is the force sensor's and the hand does not feel it: the motor opposes the "
        "force "
        "beyond the limit"};
  }
  [[nodiscard]] std::vector<Proposal> proposed(const Screening& screening) const override;
  [[nodiscard]] std::string evidence(const Effect& effect) const override {
    const std::string& unit = effect.parameters[0].unit;
    if (is_stop(effect)) {
      return "the output rests at " + with_unit(effect.value(0), unit) +
             " while the linear prediction moves on, and forgets what would have gone beyond: the "
             "body itself ends there, not its sensor";
    }
    if (is_clip(effect)) {
      return "the output rests at " + with_unit(effect.value(0), unit) +
             " while the linear prediction goes beyond, and comes back as late as it does: a limit "
             "behind the body";
    }
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

// Rows of equal values, within a stretch.
struct Run {
  std::size_t first = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t rows() const { return end - first; }
};

// The values of a signal, equal but for rounding.
class Levels {
 public:
  explicit Levels(const Signal& signal) : values_(signal.values) {
    const auto [low, high] = std::ranges::minmax(values_);
    rounding_ = kRounding * (high - low);
  }

  [[nodiscard]] bool equal(double one, double other) const {
    return std::abs(one - other) <= rounding_;
  }
  [[nodiscard]] std::ptrdiff_t count(double level) const {
    return std::ranges::count_if(values_, [&](double each) { return equal(each, level); });
  }
  [[nodiscard]] double next_to(double level) const {
    double next = HUGE_VAL;
    for (const double each : values_) {
      if (!equal(each, level) && std::abs(each - level) < std::abs(next - level)) next = each;
    }
    return next;
  }
  [[nodiscard]] std::vector<Run> runs(const std::vector<Stretch>& stretches) const {
    std::vector<Run> runs;
    for (const Stretch& stretch : stretches) {
      for (std::size_t n = stretch.first; n < stretch.end; ++n) {
        const bool goes_on = n > stretch.first && equal(values_[n], values_[n - 1]);
        if (!goes_on) runs.push_back({n, n});
        runs.back().end = n + 1;
      }
    }
    return runs;
  }

 private:
  static constexpr double kRounding = 1e-9;  // of the range

  const std::vector<double>& values_;
  double rounding_ = 0.0;
};

// That the model without a stop moves on where the output rests.
bool moves_over(const Run& run, const Screening& screening) {
  const auto at = screening.prediction().begin();
  const auto [low, high] = std::minmax_element(at + static_cast<std::ptrdiff_t>(run.first),
                                               at + static_cast<std::ptrdiff_t>(run.end));
  return *high - *low > screening.rmse();
}

// Eq. DG-89: the output rests at this end of its range, and nowhere else for as long.
bool rests_at(double end, const Screening& screening) {
  constexpr std::size_t kFewestRows = 5;
  constexpr std::size_t kLonger = 2;           // than a rest elsewhere
  constexpr std::ptrdiff_t kMoreThanNext = 4;  // a sine of few digits has 1.3 times as many
  const Signals& signals = screening.signals();
  const Levels levels(signals.output());
  Run longest;
  std::size_t elsewhere = 0;
  for (const Run& run : levels.runs(signals.stretches())) {
    if (!levels.equal(signals.output().values[run.first], end)) {
      elsewhere = std::max(elsewhere, run.rows());
    } else if (run.rows() > longest.rows()) {
      longest = run;
    }
  }
  return longest.rows() >= std::max(kFewestRows, kLonger * elsewhere) &&
         levels.count(end) >= kMoreThanNext * levels.count(levels.next_to(end)) &&
         moves_over(longest, screening);
}

// To start a stop from: the model's own body, and those of a level and of a mass.  Poles that the
// stop's state does not have would remember what it forgets.
std::vector<Body> bodies_to_stop(const Screening& screening) {
  constexpr int kMostStates = 2;
  const Model& model = screening.model();
  std::vector<Body> bodies{model.body};
  if (!model.effects.empty()) return bodies;
  for (int order = 1; order <= kMostStates; ++order) {
    if (order == static_cast<int>(model.body.order())) continue;
    bodies.push_back(new_body(screening, measured_inputs(screening),
                              screening.signals().output().values, order));
  }
  return bodies;
}

// A stop and a clip at each end of its range where the output rests.  The data hardly distinguish a
// stop from another nonlinearity inside the body.
std::vector<Proposal> where_it_rests(const Screening& screening) {
  const Model& model = screening.model();
  const bool may_stop = feedback_of(model) == nullptr && model.body.order() > 0;
  const Signal& output = screening.signals().output();
  const auto [low, high] = std::ranges::minmax(output.values);
  std::vector<Proposal> all;
  const auto add = [&](const std::string& form, double end, const Body& body) {
    const Effect effect{"output_saturation", form, {}, {constant("limit", output.unit, end)}, {}};
    all.push_back(fitted_from(effect, body, screening));
  };
  for (const auto& [side, end] : {std::pair(" above", high), std::pair(" below", low)}) {
    if (!rests_at(end, screening)) continue;
    add(std::string("clip") + side, end, model.body);
    if (!may_stop) continue;
    for (const Body& body : bodies_to_stop(screening)) add(std::string("stop") + side, end, body);
  }
  return all;
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
    if (is_soft(each.effect)) softened.push_back(fitted_from(each.effect, *each.body, screening));
  }
  const bool known = !softened.empty();
  for (const Effect& start : starts) {
    if (known || !is_soft(start)) continue;
    // As if the linear body had been fitted to the output before the limit.
    softened.push_back(fitted_from(start, first ? body_before(start, screening) : own, screening));
  }
  softened = best_of(std::move(softened), 1);
  // The clipped output may hold the linear body in a local minimum: start from the soft limit's
  // too.  Next to other effects both come from the model's own.
  std::vector<Proposal> hard;
  for (const Effect& start : starts) {
    if (is_soft(start)) continue;
    hard.push_back(fitted_from(start, own, screening));
    if (first && !softened.empty()) {
      hard.push_back(fitted_from(start, *softened.front().body, screening));
    }
  }
  std::vector<Proposal> all = best_of(std::move(hard), 2);
  append(all, std::move(softened));
  all = best_of(std::move(all), 3);
  append(all, where_it_rests(screening));
  return all;
}

}  // namespace

const EffectKind& output_saturation_kind() {
  static const OutputSaturation kKind;
  return kKind;
}

}  // namespace stillhand::diagnosis

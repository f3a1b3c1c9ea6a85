// SPDX-License-Identifier: Apache-2.0
// The report's figures.
#include <algorithm>
#include <cmath>
#include <span>

#include "apps/close_the_loop/output.hpp"
#include "apps/close_the_loop/repair_output.hpp"
#include "apps/libraries/measurement/grid.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/working_set.hpp"

namespace stillhand::close_the_loop {
namespace {

using report::Colour;

constexpr double kExcerpt_s = 12.0;
constexpr std::size_t kEvery = 20;  // samples at 1 kHz that a line of the screen shows

struct Shown {
  const TrialRun* trial;
  Colour colour;
};

std::vector<Shown> shown(const LoopResult& result) {
  return {{&result.trial("A"), Colour::kConditionA},
          {&result.trial("B"), Colour::kConditionB},
          {&result.trial("C"), Colour::kConditionC},
          {&result.trial("C'"), Colour::kConditionCPrime},
          {&result.plus(), Colour::kConditionCPlus}};
}

// Bars of one number, a condition each, with the interval of its mean.
report::Panel number_panel(const LoopRecord& record, const Number& number) {
  report::Panel panel;
  panel.title = number.title;
  panel.x.ticks = {};
  panel.y.low = 0.0;
  panel.legend = report::Legend::kNone;
  for (const Shown& each : shown(record.result)) {
    const Estimate value = measured(record.conditions, each.trial->label, number);
    add_bar(panel, each.trial->label, each.colour, value.mean, value.interval95);
  }
  return panel;
}

report::Figure tracking_figure(const LoopRecord& record) {
  report::Figure figure;
  figure.name = "tracking";
  figure.caption =
      "The paper's three metrics, the force that is left, the hand's acceleration and the motor's "
      "force: means, and 95 % intervals over the repeats. A: platform still. B: platform moving. "
      "C: "
      "cancelled with the paper's model. C': the same model; its gain and phase adapt. C+: the "
      "model "
      "with the effect; its gain and phase adapt, too.";
  figure.columns = 3;
  figure.height_px = 560;
  constexpr std::size_t kShown = 6;
  for (const Number& number : std::span(kNumbers).first(kShown)) {
    figure.panels.push_back(number_panel(record, number));
  }
  return figure;
}

// Twelve seconds from the middle of a record; the whole of a shorter one.
class MiddlePart {
 public:
  /// @param stride  samples from one that is shown to the next
  MiddlePart(const std::vector<double>& time_s, double rate_hz, std::size_t stride)
      : stride_(stride) {
    const auto count = std::min(static_cast<std::size_t>(kExcerpt_s * rate_hz), time_s.size());
    from_ = (time_s.size() - count) / 2;
    end_ = from_ + count;
    time_s_ = of(time_s);
    const double begin_s = time_s_.empty() ? 0.0 : time_s_.front();
    for (double& t : time_s_) t -= begin_s;
  }

  [[nodiscard]] std::vector<double> of(const std::vector<double>& values,
                                       double factor = 1.0) const {
    std::vector<double> out;
    for (std::size_t n = from_; n < end_; n += stride_) out.push_back(factor * values[n]);
    return out;
  }
  [[nodiscard]] report::Series line(const char* label, Colour colour, std::vector<double> y) const {
    return {.label = label, .colour = colour, .x = time_s_, .y = std::move(y)};
  }

 private:
  std::size_t stride_;
  std::size_t from_ = 0;
  std::size_t end_ = 0;
  std::vector<double> time_s_;  // [s] since its begin
};

// Part of the pegged force, and what the models leave of it.
report::Figure force_figure(const LoopRecord& record) {
  const Verdict& verdict = record.result.verdict();
  const diagnosis::Signals signals(
      diagnosis::working_set(measurement::on_grid(record.result.trial("I").measured), {"a_y"}),
      {"a_y"}, "f");
  const auto run = [&](const diagnosis::Model& model) {
    return diagnosis::free_run(model, signals).prediction;
  };
  const std::vector<double> before = run(verdict.body.baseline.model);
  const std::vector<double> after = run(verdict.body.model);
  const std::vector<double>& force = signals.output().values;
  const MiddlePart excerpt(signals.time_s(), signals.rate_hz(), 1);
  const auto left = [&](std::vector<double> predicted) {
    for (std::size_t n = 0; n < predicted.size(); ++n) predicted[n] = force[n] - predicted[n];
    return excerpt.of(predicted);
  };
  report::Figure figure;
  figure.name = "force";
  figure.caption =
      "Force of the idle hand on the pegged stick. Above: measured, and predicted from the sensed "
      "motion (free run). Below: what each model leaves.";
  figure.height_px = 520;
  report::Panel top;
  top.y.label = "force [N]";
  top.series = {excerpt.line("measured", Colour::kMeasured, excerpt.of(force)),
                excerpt.line("augmented model", Colour::kAccent, excerpt.of(after))};
  report::Panel bottom;
  bottom.x.label = "time [s]";
  bottom.y.label = "left [N]";
  bottom.series = {excerpt.line("linear model", Colour::kWarning, left(before)),
                   excerpt.line("augmented model", Colour::kAccent, left(after))};
  figure.panels = {top, bottom};
  return figure;
}

// The weights to which the canceller adapted in the newest C+; in C it does not adapt.
report::Figure adaptation_figure(const LoopResult& result) {
  report::Figure figure;
  figure.name = "adaptation";
  figure.caption =
      "Gain and phase to which the canceller adapts during C+. The motor opposes w₀ times the "
      "prediction plus w₁ times its derivative over Ω (1.2 Hz). With 1 and 0 the model is used "
      "unchanged.";
  figure.columns = 2;
  const TrialRun& plus = result.plus();
  std::vector<double> time;
  for (std::size_t n = 0; n < plus.weights.size(); ++n) {
    time.push_back(static_cast<double>(n) / kWeightRate_hz);
  }
  for (const std::size_t k : {0U, 1U}) {
    report::Panel panel;
    panel.title = k == 0 ? "gain w₀ [-]" : "phase w₁ [-]";
    panel.x.label = "time [s]";
    panel.legend = report::Legend::kNone;
    std::vector<double> values;
    for (const auto& pair : plus.weights) values.push_back(pair[k]);
    const auto [low, high] = std::ranges::minmax(values);
    panel.y.low = std::min(low, static_cast<double>(1 - k)) - 0.1;
    panel.y.high = std::max(high, static_cast<double>(1 - k)) + 0.1;
    panel.series = {{.colour = Colour::kConditionCPlus, .x = time, .y = values}};
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

// Target and cursor, the same twelve seconds under every condition that moves.
report::Figure motion_figure(const LoopResult& result) {
  report::Figure figure;
  figure.name = "motion";
  figure.caption = "Target and cursor, twelve seconds from the middle of each trial.";
  figure.columns = 1;
  const auto conditions = shown(result);
  figure.height_px = 200 * static_cast<int>(conditions.size());
  double largest = 0.0;  // one scale for all: they are to be compared
  for (const Shown& each : conditions) {
    const recording::Recording& rows = each.trial->measured;
    const MiddlePart excerpt(rows.time_s, rows.rate_hz, kEvery);
    report::Panel panel;
    panel.title = each.trial->label;
    panel.y.label = "[mm]";
    if (&each == &conditions.back()) panel.x.label = "time [s]";
    const auto mm = [&](const char* name) { return excerpt.of(rows.find(name)->values, kMmPerM); };
    panel.series = {excerpt.line("target", Colour::kTarget, mm("x_r")),
                    excerpt.line("cursor", each.colour, mm("x_p"))};
    for (const report::Series& series : panel.series) {
      for (const double y : series.y) largest = std::max(largest, std::abs(y));
    }
    figure.panels.push_back(std::move(panel));
  }
  for (report::Panel& panel : figure.panels) {
    panel.y.low = -1.05 * largest;
    panel.y.high = 1.05 * largest;
  }
  return figure;
}

}  // namespace

void add_bar(report::Panel& panel, const std::string& label, Colour colour, double value,
             const std::optional<std::pair<double, double>>& interval95) {
  const double at = static_cast<double>(panel.x.ticks.size()) + 1.0;
  panel.x.ticks.push_back({at, label});
  panel.x.low = 0.4;
  panel.x.high = at + 0.6;
  panel.series.push_back({.kind = report::Kind::kBars, .colour = colour, .x = {at}, .y = {value}});
  if (!interval95) return;
  panel.series.push_back({.kind = report::Kind::kErrorBars,
                          .colour = Colour::kTarget,
                          .x = {at},
                          .y = {value},
                          .y_low = {interval95->first},
                          .y_high = {interval95->second},
                          .point_size = 0.1});
}

std::vector<report::Figure> loop_figures(const LoopRecord& record) {
  std::vector<report::Figure> figures{tracking_figure(record), force_figure(record),
                                      adaptation_figure(record.result),
                                      motion_figure(record.result)};
  const bool any = std::ranges::any_of(record.repairs.effects,
                                       [](const Worth& each) { return each.why_not.empty(); });
  if (any) figures.push_back(repair_figure(record.repairs));
  return figures;
}

}  // namespace stillhand::close_the_loop

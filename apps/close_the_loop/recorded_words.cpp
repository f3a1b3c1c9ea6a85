// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/recorded_words.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "apps/close_the_loop/output.hpp"
#include "apps/diagnose/page/wording.hpp"
#include "apps/libraries/report/text/text.hpp"

namespace stillhand::close_the_loop {
namespace {

using report::number;

using Interval = std::optional<std::pair<double, double>>;

std::string with_interval(double value, const Interval& interval) {
  std::string text = report::short_number(value);
  if (!interval) return text;
  return fmt::format("{} [{}, {}]", text, report::short_number(interval->first),
                     report::short_number(interval->second));
}

// What C+ leaves and what C leaves, on what the loop decides, Eq. CL-9.
std::string step_text(const RecordedLoop& loop) {
  const Decision& decision = loop.decision;
  const Remaining& step = *decision.step;
  const std::string unit = diagnose::shown_unit(loop.unit);
  const double sign = step.cut() < 0.0 ? -1.0 : 1.0;
  std::string text = fmt::format(
      "{} leaves {} {} with the augmented model (C+) and {} {} with {}: {} % {}",
      decision.by_motor ? "the motor" : "the prediction", report::short_number(step.left.rms), unit,
      report::short_number(step.without.rms), unit,
      decision.by_motor && !loop.linear_control ? "the motor off" : "the linear one (C)",
      number(100.0 * sign * step.cut(), 1), sign > 0.0 ? "less" : "more");
  const Interval interval = step.cut_interval95();
  if (!interval)
    return text + "; less than three blocks of 10 s have no interval, and this decides";
  const auto [low, high] =
      std::minmax({100.0 * sign * interval->first, 100.0 * sign * interval->second});
  text += fmt::format(" [{}, {}]", number(low, 1), number(high, 1));
  return low <= 0.0 ? text + ", and the interval holds 0" : text;
}

// [unit of the output] over all unseen records.
double left_in_all(const RecordedLoop& loop, const Remaining& (*of)(const Judged&)) {
  std::vector<Level> levels;
  std::vector<double> seconds;
  for (const Judged& judged : loop.judged) {
    if (!judged.motor_augmented) continue;
    levels.push_back(of(judged).left);
    seconds.push_back(judged.seconds);
  }
  return pooled(levels, seconds).rms;
}

}  // namespace

std::string level_text(const Level& level) { return with_interval(level.rms, level.interval95); }

std::string cut_text(const Remaining& remaining) {
  std::string text = number(100.0 * remaining.cut(), 1) + " %";
  const Interval interval = remaining.cut_interval95();
  if (!interval) return text;
  return fmt::format("{} [{}, {}]", text, number(100.0 * interval->first, 1),
                     number(100.0 * interval->second, 1));
}

std::string finding_text(const Finding& finding, const std::string& unit) {
  return fmt::format("{}{} in the {}, {} {} RMS{}: {}", diagnose::spaced(finding.kind),
                     finding.channel.empty() ? "" : " (" + finding.channel + ")", finding.where,
                     with_interval(finding.explained_n, finding.interval95),
                     diagnose::shown_unit(unit), finding.counts ? "" : ", too small to count",
                     finding.evidence);
}

std::string conclusion_text(const RecordedLoop& loop) {
  const Verdict& verdict = loop.verdict;
  if (verdict.strongest() != nullptr) return {};
  return without_effect(verdict, loop.unit == "N" ? verdict.body.options.least_force_n : 0.0);
}

std::string unseen_size_text(const RecordedLoop& loop) {
  std::vector<Level> linear;
  std::vector<Level> augmented;
  std::vector<double> seconds;
  for (const Judged& judged : loop.judged) {
    linear.push_back(judged.linear.left);
    augmented.push_back(judged.augmented.left);
    seconds.push_back(judged.seconds);
  }
  const Level own = explained_beyond(pooled(linear, seconds), pooled(augmented, seconds));
  return fmt::format("On the unseen records the effects together explain {} {} RMS, by prediction.",
                     level_text(own), diagnose::shown_unit(loop.unit));
}

// The share of the force that the motor takes away, or the prediction where no motor was run.
std::string cuts_text(const RecordedLoop& loop) {
  const Judged& last = loop.judged.back();
  const bool motor = last.motor_linear || last.motor_augmented;
  const auto cut = [&](const std::optional<Remaining>& by_motor, const Remaining& by_prediction) {
    if (!motor) return cut_text(by_prediction);
    return by_motor ? cut_text(*by_motor) : std::string("nothing, because it does not run,");
  };
  return fmt::format(
      "On {}, which no fit has seen, {} removes {} of the force with the linear model (C) and {} "
      "with the augmented one (C+).",
      last.source, motor ? "the motor" : "the prediction", cut(last.motor_linear, last.linear),
      cut(last.motor_augmented, last.augmented));
}

// What became of the augmented model on the unseen records.
std::string kept_text(const RecordedLoop& loop) {
  const Decision& decision = loop.decision;
  const std::string warning = decision.helps
                                  ? ""
                                  : " It leaves more force than no model does: check the signs, "
                                    "units and channels of the unseen records.";
  if (decision.same) return decision.helps ? "" : "The linear model (C) is kept." + warning;
  if (!decision.step) {
    return "C+ is not kept, because it did not run: the linear model (C) stays." + warning;
  }
  const std::string worse =
      decision.worse.empty()
          ? ""
          : fmt::format(" C+ leaves more of {}.", fmt::join(decision.worse, " and of "));
  return fmt::format("C+ is {}: on the unseen records {}.{}{}{}",
                     decision.kept() ? "kept" : "not kept", step_text(loop), worse,
                     decision.kept() ? "" : " The linear model (C) stays, also for the canceller.",
                     warning);
}

// Why no motor ran, or ran with one model alone; empty: both ran.
std::string motor_text(const RecordedLoop& loop) {
  if (!loop.no_motor.empty()) return "No motor was run: " + loop.no_motor + ".";
  std::string text;
  const auto add = [&](const char* model, const std::string& why) {
    if (why.empty()) return;
    text += fmt::format("{}The motor was not run with the {} model: {}.", text.empty() ? "" : " ",
                        model, why);
  };
  add("linear", loop.linear_not_carried);
  add("augmented", loop.verdict.not_carried);
  return text;
}

// Why the motor leaves more with the augmented model than its prediction does; empty: it does not.
std::string parted_text(const RecordedLoop& loop) {
  constexpr double kAsMuch = 1.05;  // the lag of a sound model costs less
  const Decision& decision = loop.decision;
  if (decision.same || !decision.by_motor || !decision.step) return {};
  const double predicted =
      left_in_all(loop, [](const Judged& judged) -> const Remaining& { return judged.augmented; });
  if (decision.step->left.rms <= kAsMuch * predicted) return {};
  std::string text = fmt::format(
      "Prediction and motor differ: with the augmented model the prediction leaves {} {} and the "
      "motor {}.",
      report::short_number(predicted), diagnose::shown_unit(loop.unit),
      report::short_number(decision.step->left.rms));
  for (const Treatment& each : loop.verdict.control.treatments) {
    text +=
        fmt::format(" {}: {} ({}).", each.cancelled ? "Changed for the canceller" : "Left alone",
                    diagnose::spaced(each.kind), each.how);
  }
  if (loop.linear_control) {
    const double linear =
        left_in_all(loop, [](const Judged& judged) -> const Remaining& { return judged.linear; });
    text += fmt::format(
        " With the linear model, where only lag, delay and limits make a difference, the "
        "prediction leaves {} and the motor {}.",
        report::short_number(linear), report::short_number(decision.step->without.rms));
  }
  double limited = 0.0;
  for (const Judged& judged : loop.judged) {
    if (judged.motor_augmented) limited = std::max(limited, judged.motor_augmented->limited_share);
  }
  return text + fmt::format(
                    " The motor's limits held for {} % of the time. The canceller's model is "
                    "off by at most {} % in the band of the motion.",
                    number(100.0 * limited, 1),
                    number(100.0 * loop.verdict.control.conversion_error, 2));
}

}  // namespace stillhand::close_the_loop

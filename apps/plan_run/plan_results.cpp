// SPDX-License-Identifier: Apache-2.0
#include "apps/plan_run/plan_results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "services/core/recording/csv.hpp"
#include "services/core/signal/spectrum.hpp"
#include "services/files/digest/digest.hpp"
#include "services/files/next_run/plan_file.hpp"

namespace stillhand::plan_run {
namespace {

using nlohmann::ordered_json;

std::size_t count_of(const Planned& planned) { return planned.contest.candidates().size(); }

std::string name_at(const Planned& planned, std::size_t i) {
  return next_run::name_of(planned.contest.candidates()[i]);
}

// The direction that the run settles less often.
double chance_between(const next_run::Plan& plan, std::size_t i, std::size_t j) {
  const auto row = static_cast<Eigen::Index>(i);
  const auto column = static_cast<Eigen::Index>(j);
  return std::min(plan.chance(row, column), plan.chance(column, row));
}

// Places of the pairs that no motion settles.
std::vector<std::pair<std::size_t, std::size_t>> out_of_reach(const Planned& planned) {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < count_of(planned); ++i) {
    for (std::size_t j = i + 1; j < count_of(planned); ++j) {
      if (planned.plan.out_of_reach(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j))) {
        pairs.emplace_back(i, j);
      }
    }
  }
  return pairs;
}

ordered_json longer_json(const Planned& planned) {
  ordered_json longer = ordered_json::array();
  for (const next_run::Lasting& each : planned.longer) {
    longer.push_back(
        {{"seconds", each.seconds}, {"probability_settled", each.probability_settled}});
  }
  return longer;
}

ordered_json pairs_json(const Planned& planned) {
  const next_run::Expected& expected = planned.plan.expected;
  ordered_json pairs = ordered_json::array();
  for (std::size_t i = 0; i < count_of(planned); ++i) {
    for (std::size_t j = 0; j < count_of(planned); ++j) {
      if (i == j) continue;
      const auto row = static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(j);
      pairs.push_back({{"true", i},
                       {"rival", j},
                       {"evidence_now", planned.contest.before().twice_log_ratio(row, column)},
                       {"evidence_expected", expected.separation(row, column) +
                                                 expected.price[column] - expected.price[row]},
                       {"probability_settled", planned.plan.chance(row, column)},
                       {"out_of_reach", planned.plan.out_of_reach(row, column)}});
    }
  }
  return pairs;
}

ordered_json motion_json(const Planned& planned) {
  const next_run::Design& design = planned.plan.design;
  const motion::MotionReport& report = planned.plan.ride.motion.report();
  return {{"family", next_run::in_words(design.family)},
          {"band_hz", {design.low_hz, design.high_hz}},
          {"rms_m_s2", report.rms_m_s2},
          {"peak_m_s2", report.peak_m_s2},
          {"largest_displacement_m", report.peak_position_m},
          {"largest_velocity_m_s", report.peak_velocity_m_s},
          {"quiet_share", design.quiet}};
}

ordered_json limits_json(const Planned& planned) {
  const motion::PlatformLimits& limits = planned.bounds.limits;
  const motion::MotionProfile& ride = planned.bounds.ride;
  return {{"position_m", limits.max_position_m},
          {"velocity_m_s", limits.max_velocity_m_s},
          {"acceleration_m_s2", std::min(limits.max_acceleration_m_s2, ride.peak_m_s2)},
          {"band_hz", {ride.band_low_hz, ride.band_high_hz}}};
}

report::Series spectrum_of(const std::vector<double>& values, double rate_hz) {
  constexpr double kSegment_s = 5.0;
  const auto segment = 2 * static_cast<std::size_t>(0.5 * kSegment_s * rate_hz);
  const auto spectra =
      signal::cross_spectra(values, values, rate_hz, std::min(segment, values.size() / 2 * 2));
  report::Series series;
  series.x = spectra.frequency_hz;
  series.y = spectra.s_xx;
  return series;
}

}  // namespace

std::vector<std::string> advice_for(const next_run::Contest& contest, const next_run::Plan& plan,
                                    const diagnosis::Signals& signals) {
  constexpr double kOftenEnough = 0.5;
  const auto& candidates = contest.candidates();
  std::vector<std::string> advice;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = i + 1; j < candidates.size(); ++j) {
      if (chance_between(plan, i, j) >= kOftenEnough) continue;
      for (const std::string& way : next_run::other_ways(candidates[i], candidates[j], signals)) {
        std::string line = fmt::format("{} or {}: {}", next_run::name_of(candidates[i]),
                                       next_run::name_of(candidates[j]), way);
        advice.push_back(std::move(line));
      }
    }
  }
  return advice;
}

std::string plan_json(const Planned& planned) {
  const diagnosis::Model& model = planned.contest.candidates().front().model;
  ordered_json json{{"inputs", model.inputs},
                    {"output", model.output},
                    {"seconds", planned.seconds},
                    {"probability_settled", planned.plan.probability_settled},
                    {"probability_repeated", planned.plan.probability_repeated},
                    {"longer", longer_json(planned)},
                    {"ride", next_run::kRideName},
                    {"ride_sha256", digest::sha256(ride_csv(planned.plan.ride))},
                    {"motion", motion_json(planned)},
                    {"limits", limits_json(planned)},
                    {"designs_tried", planned.plan.tried},
                    {"noise_rms", planned.contest.noise_rms()},
                    {"advice", planned.advice},
                    {"pairs", pairs_json(planned)}};
  json["candidates"] = ordered_json::array();
  for (const auto& candidate : planned.contest.candidates()) {
    json["candidates"].push_back(next_run::json_of(candidate));
  }
  return json.dump(2) + "\n";
}

std::string plan_table(const Planned& planned) {
  const next_run::Plan& plan = planned.plan;
  const motion::MotionReport& report = plan.ride.motion.report();
  std::string text;
  for (std::size_t i = 0; i < count_of(planned); ++i) {
    const auto& candidate = planned.contest.candidates()[i];
    text += fmt::format("{}    {}, error on unseen samples {:.4g} {}\n", i == 0 ? "tied" : "    ",
                        name_at(planned, i), candidate.heldout_rmse, candidate.model.output_unit);
  }
  text += fmt::format(
      "motion  {}, {:.2f} to {:.2f} Hz, {:.2f} m/s^2 RMS, peak {:.2f} m/s^2 and {:.3f} m, {:g} s\n",
      next_run::in_words(plan.design.family), plan.design.low_hz, plan.design.high_hz,
      report.rms_m_s2, report.peak_m_s2, report.peak_position_m, planned.seconds);
  text += fmt::format("settles {:.0f} % (at least; the recorded motion for as long: {:.0f} %)\n",
                      100.0 * plan.probability_settled, 100.0 * plan.probability_repeated);
  for (const next_run::Lasting& each : planned.longer) {
    text +=
        fmt::format("        {:.0f} % in {:g} s\n", 100.0 * each.probability_settled, each.seconds);
  }
  for (const auto& [i, j] : out_of_reach(planned)) {
    text += fmt::format(
        "no motion of this platform separates {} from {} in {:g} s ({} designs tried)\n",
        name_at(planned, i), name_at(planned, j), planned.seconds, plan.tried);
  }
  for (const std::string& line : planned.advice) text += fmt::format("note: {}\n", line);
  return text;
}

std::string ride_csv(const next_run::Ride& ride) {
  recording::Recording table;
  table.columns.push_back({"a_y", "m/s^2", ride.accel_m_s2});
  for (std::size_t n = 0; n < ride.accel_m_s2.size(); ++n) {
    table.time_s.push_back(static_cast<double>(n) / next_run::Ride::kRate_hz);
  }
  return recording::to_csv(table);
}

report::Figure plan_figure(const Planned& planned) {
  constexpr int kSteps = 8;  // as the plan was judged
  constexpr double kHighest_hz = 10.0;
  constexpr std::array kColours{report::Colour::kAccent, report::Colour::kWarning,
                                report::Colour::kConditionC, report::Colour::kConditionB};
  const diagnosis::Measurement& run = planned.plan.run;
  const diagnosis::Model& model = planned.contest.candidates().front().model;
  const std::vector<double> time_s = run.time_s();
  const std::vector<double>& motion = run.find(model.inputs.front())->values;
  const std::string unit = " [" + model.output_unit + "]";
  report::Panel over_time{.title = "the motion",
                          .x = {.label = "time [s]"},
                          .y = {.label = model.inputs.front() + " [m/s²]"}};
  over_time.series.push_back({.label = next_run::in_words(planned.plan.design.family),
                              .colour = report::Colour::kMeasured,
                              .x = time_s,
                              .y = motion});
  report::Panel motion_spectrum{.title = "its spectrum",
                                .x = {.label = "frequency [Hz]", .low = 0.0, .high = kHighest_hz},
                                .y = {.label = "PSD [m²/s⁴/Hz]"}};
  motion_spectrum.series.push_back(spectrum_of(motion, run.rate_hz));
  report::Panel apart{.title = "what each leaves of the prediction of " + name_at(planned, 0),
                      .x = {.label = "time [s]"},
                      .y = {.label = model.output + unit}};
  report::Panel apart_spectrum{.title = "spectrum of what is left",
                               .x = {.label = "frequency [Hz]", .low = 0.0, .high = kHighest_hz},
                               .y = {.label = "PSD [" + model.output_unit + "²/Hz]"},
                               .legend = report::Legend::kNone};
  for (std::size_t i = 1; i < count_of(planned); ++i) {
    const report::Colour colour = kColours[(i - 1) % kColours.size()];
    const Eigen::VectorXd left = planned.contest.unmatched(0, i, run, kSteps);
    const std::vector<double> values(left.begin(), left.end());
    apart.series.push_back(
        {.label = name_at(planned, i), .colour = colour, .x = time_s, .y = values});
    report::Series lines = spectrum_of(values, run.rate_hz);
    lines.colour = colour;
    apart_spectrum.series.push_back(std::move(lines));
  }
  return {.name = "plan",
          .panels = {over_time, motion_spectrum, apart, apart_spectrum},
          .columns = 2,
          .width_px = 1180,
          .height_px = 620};
}

}  // namespace stillhand::plan_run

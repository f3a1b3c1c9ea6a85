// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/region_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "apps/libraries/report/provenance.hpp"
#include "apps/libraries/report/text/text.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::vehicle {
namespace {

using report::Colour;
using report::Kind;
using report::Series;

constexpr double kHighestShown = 130.0;  // [m/s^2 per rad] of the figure; the grid ends at 100

const char* condition_words(bool cancel) {
  return cancel ? "with cancellation" : "without cancellation";
}

// Middle and range over subjects of the predicted limit.
struct Predicted {
  double middle = 0.0, low = 0.0, high = 0.0;
};

Predicted predicted_over_subjects(const Region& region, bool cancel, double delay_s) {
  std::vector<double> gains;
  for (const Limit& limit : region.limits) {
    if (limit.cancel == cancel && limit.delay_s == delay_s) {
      gains.push_back(std::min(limit.predicted.gain_m_s2_rad, kHighestShown));
    }
  }
  std::ranges::sort(gains);
  return {gains[gains.size() / 2], gains.front(), gains.back()};
}

// Drives of one place of the grid that were ended, of how many.
struct Share {
  int ended = 0, all = 0;
};

Share share_at(const Region& region, bool cancel, double delay_s, double gain) {
  Share out;
  for (const Drive& run : region.runs) {
    if (run.cancel != cancel || run.delay_s != delay_s || run.gain_m_s2_rad != gain) continue;
    ++out.all;
    out.ended += run.outcome.ended ? 1 : 0;
  }
  return out;
}

void add(Series& series, double delay_s, double gain) {
  series.x.push_back(1e3 * delay_s);
  series.y.push_back(gain);
}

report::Panel region_panel(const RegionOptions& options, const Region& region, bool cancel) {
  report::Panel panel;
  panel.title = condition_words(cancel);
  panel.x.label = "delay [ms]";
  panel.x.low = 0.0;
  panel.y.label = "gain [m/s² per rad]";
  panel.y.scale = report::Scale::kLogarithmic;
  panel.y.low = 0.9 * options.gains_m_s2_rad.front();
  panel.y.high = kHighestShown;
  const Colour colour = cancel ? Colour::kConditionC : Colour::kConditionB;
  Series band{.label = "predicted limit, all subjects", .kind = Kind::kBand, .colour = colour};
  Series line{.label = "middle subject", .kind = Kind::kLine, .colour = colour};
  Series all{.label = "drives: all ended", .kind = Kind::kPoints, .colour = Colour::kWarning};
  Series some{.label = "some ended", .kind = Kind::kPoints, .colour = Colour::kAccent};
  Series none{.label = "all stable", .kind = Kind::kPoints, .colour = Colour::kNeutral};
  none.point_size = 0.5;
  for (const double delay_s : options.delays_s) {
    const Predicted predicted = predicted_over_subjects(region, cancel, delay_s);
    band.x.push_back(1e3 * delay_s);
    band.y_low.push_back(predicted.low);
    band.y_high.push_back(predicted.high);
    add(line, delay_s, predicted.middle);
    for (const double gain : options.gains_m_s2_rad) {
      const Share share = share_at(region, cancel, delay_s, gain);
      add(share.ended == 0 ? none : share.ended == share.all ? all : some, delay_s, gain);
    }
  }
  panel.series = {band, line, all, some, none};
  return panel;
}

nlohmann::json or_null(double value) {
  return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json agreement_json(const Agreement& agreed) {
  return {{"limits", agreed.limits},
          {"beyond_grid", agreed.beyond},
          {"predicted_but_never_ended", agreed.never_ended},
          {"ended_at_the_first_gain", agreed.at_once},
          {"interval_meets_step", agreed.within},
          {"predicted_over_run",
           {{"median", or_null(agreed.median)},
            {"least", or_null(agreed.least)},
            {"most", or_null(agreed.most)}}}};
}

// A limit may be infinite: then there is no ratio.
std::vector<double> finite(std::vector<double> ratios) {
  std::erase_if(ratios, [](double ratio) { return !std::isfinite(ratio); });
  return ratios;
}

// How much larger the critical gain is with cancellation: of each subject and delay.
std::vector<double> gain_ratios(const Region& region) {
  std::vector<double> ratios;
  for (const Limit& without : region.limits) {
    if (without.cancel) continue;
    const auto with = std::ranges::find_if(region.limits, [&](const Limit& each) {
      return each.cancel && each.subject == without.subject && each.delay_s == without.delay_s;
    });
    ratios.push_back(with->predicted.gain_m_s2_rad / without.predicted.gain_m_s2_rad);
  }
  return finite(std::move(ratios));
}

std::vector<double> pegged_ratios(const Region& region) {
  std::vector<double> ratios;
  for (const Limit& limit : region.limits) {
    if (!limit.cancel) ratios.push_back(limit.pegged_m_s2_rad / limit.predicted.gain_m_s2_rad);
  }
  return finite(std::move(ratios));
}

nlohmann::json range_json(const std::vector<double>& ratios) {
  if (ratios.empty()) return nullptr;
  const auto [least, most] = std::ranges::minmax(ratios);
  return {{"median", statistics::median(ratios)},
          {"least", least},
          {"most", most},
          {"of", ratios.size()}};
}

std::string range_text(const std::vector<double>& ratios) {
  if (ratios.empty()) return "no limit is finite";
  const auto [least, most] = std::ranges::minmax(ratios);
  return fmt::format("median {:.2f}, {:.2f} to {:.2f} of {}", statistics::median(ratios), least,
                     most, ratios.size());
}

}  // namespace

report::Figure region_figure(const RegionOptions& options, const Region& region) {
  report::Figure figure;
  figure.name = kRegionFigure;
  figure.caption =
      "Stable region of the loop through vehicle and hand, " + options.preset +
      ". Band and line: critical gain predicted by Nyquist from identified responses. Marks: "
      "drives of all subjects; a drive is ended by the detector of growing oscillation.";
  figure.columns = 2;
  figure.width_px = 980;
  figure.height_px = 460;
  figure.panels = {region_panel(options, region, false), region_panel(options, region, true)};
  return figure;
}

std::string runs_csv(const Region& region) {
  std::string out =
      "subject,cancellation,delay [s],gain [m/s^2/rad],ended,ended_after [s],frequency [Hz],"
      "periods_from_floor,periods_from_ceiling,largest_theta [rad],last_rms_theta [rad],"
      "rest_after [s],motor_zero_after [s],largest_x [m],largest_v [m/s],largest_a [m/s^2],"
      "shaped\n";
  for (const Drive& run : region.runs) {
    const DriveOutcome& d = run.outcome;
    out += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", run.subject + 1, run.cancel ? 1 : 0,
        run.delay_s, report::decimal(run.gain_m_s2_rad), d.ended ? 1 : 0, d.ended_s,
        report::decimal(d.frequency_hz), report::decimal(d.periods_from_floor),
        report::decimal(d.periods_from_ceiling), report::decimal(d.largest_rad),
        report::decimal(d.rms_rad), d.rest_s, d.motor_zero_s, report::decimal(d.farthest_m),
        report::decimal(d.fastest_m_s), report::decimal(d.hardest_m_s2), d.shaped ? 1 : 0);
  }
  return out;
}

std::string limits_csv(const Region& region) {
  std::string out =
      "subject,cancellation,delay [s],predicted [m/s^2/rad],low95 [m/s^2/rad],high95 [m/s^2/rad],"
      "predicted_frequency [Hz],pegged_route [m/s^2/rad],largest_stable [m/s^2/rad],"
      "smallest_ended [m/s^2/rad]\n";
  for (const Limit& limit : region.limits) {
    out += fmt::format(
        "{},{},{},{},{},{},{},{},{},{}\n", limit.subject + 1, limit.cancel ? 1 : 0, limit.delay_s,
        report::decimal(limit.predicted.gain_m_s2_rad),
        report::decimal(limit.predicted.low_m_s2_rad),
        report::decimal(limit.predicted.high_m_s2_rad), report::decimal(limit.predicted_hz),
        limit.cancel ? "" : report::decimal(limit.pegged_m_s2_rad),
        report::decimal(limit.stable_m_s2_rad),
        std::isfinite(limit.ended_m_s2_rad) ? report::decimal(limit.ended_m_s2_rad) : "");
  }
  return out;
}

std::string region_json(const RegionOptions& options, const Region& region) {
  const Stops stopped = stops(region);
  nlohmann::json out = {{"preset", options.preset},
                        {"subjects", options.subjects},
                        {"seed", options.seed},
                        {"drive_s", options.drive_s},
                        {"without_cancellation", agreement_json(agreement(region.limits, false))},
                        {"with_cancellation", agreement_json(agreement(region.limits, true))},
                        {"critical_gain_with_over_without", range_json(gain_ratios(region))},
                        {"pegged_route_over_free_stick", range_json(pegged_ratios(region))},
                        {"detector",
                         {{"drives", stopped.drives},
                          {"ended", stopped.ended},
                          {"drives_below_0.7_of_critical", stopped.well_below},
                          {"ended_of_these", stopped.well_below_ended},
                          {"minutes_of_these", stopped.well_below_minutes},
                          {"median_periods_from_floor", or_null(stopped.median_periods)},
                          {"share_within_two_periods_of_floor", stopped.share_within_two},
                          {"most_periods_from_ceiling", stopped.most_periods_from_ceiling},
                          {"longest_to_platform_at_rest_s", stopped.longest_rest_s},
                          {"longest_to_motor_zero_s", stopped.longest_motor_s},
                          {"largest_theta_rad", stopped.largest_rad},
                          {"largest_rms_of_a_drive_not_ended_rad", stopped.largest_left_rad}}}};
  return out.dump(2) + "\n";
}

std::string region_text(const RegionOptions& options, const Region& region) {
  std::string out = fmt::format("{}, {} subjects, {} drives\n", options.preset, options.subjects,
                                region.runs.size());
  for (const bool cancel : {false, true}) {
    const Agreement agreed = agreement(region.limits, cancel);
    out += fmt::format(
        "{:<21} predicted / run limit: median {:.2f}, {:.2f} to {:.2f} ({} limits; "
        "interval meets the grid's step in {}; beyond the grid {}, predicted but never ended {}, "
        "ended "
        "at the first gain {})\n",
        condition_words(cancel), agreed.median, agreed.least, agreed.most, agreed.limits,
        agreed.within, agreed.beyond, agreed.never_ended, agreed.at_once);
  }
  const Stops stopped = stops(region);
  out += "critical gain with / without cancellation: " + range_text(gain_ratios(region)) + "\n";
  out += "critical gain by the pegged route / by the free stick: " +
         range_text(pegged_ratios(region)) + "\n";
  out += fmt::format(
      "ended {} of {} drives; within two periods of the floor {:.1f} %, median "
      "{:.2f} periods; of the ceiling at most {:.2f} periods\n",
      stopped.ended, stopped.drives, 100.0 * stopped.share_within_two, stopped.median_periods,
      stopped.most_periods_from_ceiling);
  out +=
      fmt::format("after the end: platform at rest within {:.3f} s, motor at 0 within {:.3f} s\n",
                  stopped.longest_rest_s, stopped.longest_motor_s);
  out += fmt::format(
      "false alarms: {} in {:.1f} min of drives below 0.7 of the predicted critical "
      "gain\n",
      stopped.well_below_ended, stopped.well_below_minutes);
  out += fmt::format(
      "largest stick angle {:.3f} rad; largest RMS at the end of a drive that was "
      "not ended {:.4f} rad\n",
      stopped.largest_rad, stopped.largest_left_rad);
  return out;
}

report::Page region_page(const RegionOptions& options, const Region& region,
                         const std::string& command_line,
                         const std::vector<report::Drawing>& drawings) {
  report::Page page("Vehicle in the loop",
                    "Stable region of the loop through vehicle and hand. All subjects are "
                    "simulated.");
  page.banner(report::kSimulatedBanner);
  page.facts({{"preset", options.preset},
              {"subjects", fmt::to_string(options.subjects)},
              {"seed", fmt::to_string(options.seed)},
              {"made by", report::made_by()},
              {"command", command_line}});
  page.section("Stable region");
  for (const report::Drawing& drawing : drawings) page.figure(drawing);
  report::Table table;
  table.caption =
      "Critical gain [m/s² per rad], middle subject, and the largest stable and "
      "smallest ended gain of all subjects' drives.";
  table.header = {"delay [ms]",      "cancellation", "predicted",  "lowest subject",
                  "highest subject", "first ended",  "last stable"};
  for (const bool cancel : {false, true}) {
    for (const double delay_s : options.delays_s) {
      const Predicted predicted = predicted_over_subjects(region, cancel, delay_s);
      double first = std::numeric_limits<double>::infinity();
      double last = 0.0;
      for (const Limit& limit : region.limits) {
        if (limit.cancel != cancel || limit.delay_s != delay_s) continue;
        first = std::min(first, limit.ended_m_s2_rad);
        last = std::max(last, limit.stable_m_s2_rad);
      }
      table.rows.push_back({report::number(1e3 * delay_s, 0), cancel ? "yes" : "no",
                            report::number(predicted.middle, 1), report::number(predicted.low, 1),
                            report::number(predicted.high, 1), report::number(first, 1),
                            report::number(last, 1)});
    }
  }
  page.table(table);
  page.section("Agreement, and what the detector did");
  const std::string text = region_text(options, region);
  std::vector<std::string> lines;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t to = text.find('\n', from);
    lines.push_back(text.substr(from, to - from));
    from = to + 1;
  }
  page.list(lines);
  return page;
}

std::vector<std::string> region_files() {
  return {"report.html",
          "summary.json",
          "runs.csv",
          "limits.csv",
          std::string(kRegionFigure) + ".svg",
          std::string(kRegionFigure) + ".png",
          std::string(kRegionFigure) + ".csv"};
}

}  // namespace stillhand::vehicle

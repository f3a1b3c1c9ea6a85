// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/region.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "services/core/population/population.hpp"
#include "services/core/statistics/descriptive.hpp"
#include "services/system/process/run_jobs.hpp"

namespace stillhand::vehicle {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kIdentifyShare = 0.2;  // of the progress line

// The settings of a subject's drive; every drive of a subject is another draw of its own forces.
DriveConfigs configs_of(const RegionOptions& options, std::int64_t subject) {
  DriveConfigs configs;
  configs.rig.body = population::draw_subject({}, options.seed, subject).body;
  configs.driven.vehicle = preset(options.preset);
  return configs;
}

std::uint64_t drive_seed(const RegionOptions& options, std::size_t run) {
  return options.seed * 1'000'003u + run + 1;
}

void check_list(const char* option, const std::vector<double>& values, double low, double high) {
  const bool rises =
      std::adjacent_find(values.begin(), values.end(), std::greater_equal<>()) == values.end();
  if (values.empty() || !rises || !(values.front() >= low) || !(values.back() <= high)) {
    throw ConfigError(option, fmt::format("{}", fmt::join(values, ",")),
                      fmt::format("numbers that rise, from {} to {}", low, high));
  }
}

std::vector<Drive> planned_runs(const RegionOptions& options) {
  std::vector<Drive> runs;
  for (std::int64_t subject = 0; subject < options.subjects; ++subject) {
    for (const bool cancel : {false, true}) {
      for (const double delay_s : options.delays_s) {
        for (const double gain : options.gains_m_s2_rad) {
          runs.push_back({subject, cancel, delay_s, gain, {}});
        }
      }
    }
  }
  return runs;
}

Limit predicted_limit(const RegionOptions& options, const IdentifiedHand& hand,
                      std::int64_t subject, bool cancel, double delay_s) {
  VehicleConfig vehicle = preset(options.preset);
  vehicle.delay_s = delay_s;
  const IdentifiedResponse& theta = cancel ? hand.cancelled : hand.feedthrough;
  Limit limit;
  limit.subject = subject;
  limit.cancel = cancel;
  limit.delay_s = delay_s;
  limit.predicted = critical_gain(vehicle, theta);
  limit.predicted_hz = margin(vehicle, theta).frequency_hz;
  if (!cancel) limit.pegged_m_s2_rad = margin(vehicle, hand.from_pegged).critical_gain_m_s2_rad;
  return limit;
}

// Largest stable and smallest ended gain of the drives of one limit, which come in rising order.
void add_runs(Limit& limit, const std::vector<Drive>& runs) {
  limit.ended_m_s2_rad = kInfinite;
  for (const Drive& run : runs) {
    if (run.subject != limit.subject || run.cancel != limit.cancel ||
        run.delay_s != limit.delay_s) {
      continue;
    }
    if (run.outcome.ended) {
      limit.ended_m_s2_rad = run.gain_m_s2_rad;
      return;
    }
    limit.stable_m_s2_rad = run.gain_m_s2_rad;
  }
}

double middle(const std::vector<double>& values) {
  return values.empty() ? std::nan("") : statistics::median(values);
}

}  // namespace

std::vector<double> geometric_gains() {
  std::vector<double> gains;
  constexpr int kSteps = 16;
  for (int k = 0; k <= kSteps; ++k) gains.push_back(4.0 * std::pow(25.0, k / double{kSteps}));
  return gains;
}

Region map_region(const RegionOptions& given,
                  const std::function<bool(const char* step, double done)>& progress) {
  RegionOptions options = given;
  if (options.gains_m_s2_rad.empty()) options.gains_m_s2_rad = geometric_gains();
  check_list("--gains", options.gains_m_s2_rad, 0.1, 100.0);
  check_list("--delays", options.delays_s, 0.02, 1.0);
  const unsigned threads = options.threads > 0 ? options.threads : runtime::core_count();

  const auto subjects = static_cast<std::size_t>(options.subjects);
  std::vector<IdentifiedHand> hands(subjects);
  const auto identify = [&](std::size_t k) {
    const auto subject = static_cast<std::int64_t>(k);
    hands[k] = identify_hand(configs_of(options, subject), options.seed + k, options.identify);
  };
  bool complete = runtime::run_jobs(subjects, threads, identify, [&](std::size_t done) {
    return progress("identification",
                    kIdentifyShare * static_cast<double>(done) / static_cast<double>(subjects));
  });
  if (!complete) return {};

  Region region;
  region.runs = planned_runs(options);
  const auto drive = [&](std::size_t k) {
    Drive& run = region.runs[k];
    DriveConfigs configs = configs_of(options, run.subject);
    configs.driven.vehicle.delay_s = run.delay_s;
    configs.driven.vehicle.gain_m_s2_rad = run.gain_m_s2_rad;
    DriveLoop loop(configs, drive_seed(options, k));
    loop.use_model(hands[static_cast<std::size_t>(run.subject)].model);
    run.outcome = loop.run(options.drive_s, run.cancel);
  };
  complete = runtime::run_jobs(region.runs.size(), threads, drive, [&](std::size_t done) {
    const double share = static_cast<double>(done) / static_cast<double>(region.runs.size());
    return progress("drives", kIdentifyShare + (1.0 - kIdentifyShare) * share);
  });
  if (!complete) return {};

  for (std::size_t k = 0; k < subjects; ++k) {
    for (const bool cancel : {false, true}) {
      for (const double delay_s : options.delays_s) {
        Limit limit =
            predicted_limit(options, hands[k], static_cast<std::int64_t>(k), cancel, delay_s);
        add_runs(limit, region.runs);
        region.limits.push_back(limit);
      }
    }
  }
  return region;
}

Agreement agreement(const std::vector<Limit>& limits, bool cancel) {
  Agreement out;
  std::vector<double> ratios;
  for (const Limit& limit : limits) {
    if (limit.cancel != cancel) continue;
    if (limit.ended_m_s2_rad == kInfinite) {
      ++(limit.predicted.gain_m_s2_rad >= limit.stable_m_s2_rad ? out.beyond : out.never_ended);
      continue;
    }
    if (!(limit.stable_m_s2_rad > 0.0)) {
      ++out.at_once;
      continue;
    }
    ratios.push_back(limit.predicted.gain_m_s2_rad /
                     std::sqrt(limit.stable_m_s2_rad * limit.ended_m_s2_rad));
    if (limit.predicted.low_m_s2_rad <= limit.ended_m_s2_rad &&
        limit.predicted.high_m_s2_rad >= limit.stable_m_s2_rad) {
      ++out.within;
    }
  }
  out.limits = static_cast<int>(ratios.size());
  if (ratios.empty()) return out;
  out.median = middle(ratios);
  const auto [least, most] = std::minmax_element(ratios.begin(), ratios.end());
  out.least = *least;
  out.most = *most;
  return out;
}

Stops stops(const Region& region) {
  Stops out;
  std::vector<double> periods;
  int within_two = 0;
  for (const Drive& run : region.runs) {
    const DriveOutcome& drive = run.outcome;
    ++out.drives;
    out.largest_rad = std::max(out.largest_rad, drive.largest_rad);
    const auto limit = std::ranges::find_if(region.limits, [&](const Limit& each) {
      return each.subject == run.subject && each.cancel == run.cancel &&
             each.delay_s == run.delay_s;
    });
    if (run.gain_m_s2_rad < 0.7 * limit->predicted.gain_m_s2_rad) {
      ++out.well_below;
      out.well_below_ended += drive.ended ? 1 : 0;
      out.well_below_minutes += drive.minutes;
    }
    if (!drive.ended) {
      out.largest_left_rad = std::max(out.largest_left_rad, drive.rms_rad);
      continue;
    }
    ++out.ended;
    periods.push_back(drive.periods_from_floor);
    within_two += drive.periods_from_floor <= 2.0 ? 1 : 0;
    out.most_periods_from_ceiling =
        std::max(out.most_periods_from_ceiling, drive.periods_from_ceiling);
    out.longest_rest_s = std::max(out.longest_rest_s, drive.rest_s);
    out.longest_motor_s = std::max(out.longest_motor_s, drive.motor_zero_s);
  }
  out.median_periods = middle(periods);
  out.share_within_two = out.ended > 0 ? within_two / static_cast<double>(out.ended) : 0.0;
  return out;
}

}  // namespace stillhand::vehicle

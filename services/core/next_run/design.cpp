// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "services/core/contract/config_error.hpp"

namespace stillhand::next_run {
namespace {

using diagnosis::Measurement;
using diagnosis::Stretch;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kRideStep_s = 1.0 / Ride::kRate_hz;
constexpr double kMargin = 0.98;  // of each limit: the ride's filter changes peaks a little

std::size_t samples_of(const Bounds& bounds) {
  const Tick ticks = bounds.ride.duration_ticks + bounds.ride.ramp_ticks;
  return static_cast<std::size_t>(
             std::ceil(static_cast<double>(ticks) * kControlPeriod_s * Ride::kRate_hz)) +
         1;
}

// Noise or multisine as the project's generator makes it.
motion::MotionTrajectory generated(const Design& design, const Bounds& bounds, double rms_m_s2) {
  motion::MotionProfile profile = bounds.ride;
  profile.kind = design.family == Family::kMultisine ? motion::MotionKind::kMultisine
                                                     : motion::MotionKind::kBandNoise;
  profile.band_low_hz = design.low_hz;
  profile.band_high_hz = design.high_hz;
  profile.band_order = 0;
  profile.seed = design.seed;
  profile.duration_ticks = bounds.ride.duration_ticks + bounds.ride.ramp_ticks;
  profile.peak_m_s2 = kMargin * bounds.ride.peak_m_s2;
  profile.ride_accel_m_s2.clear();
  profile.rms_m_s2 = rms_m_s2;
  motion::PlatformLimits limits = bounds.limits;
  limits.max_position_m *= kMargin;
  limits.max_velocity_m_s *= kMargin;
  return {profile, limits};
}

// As loud as the limits allow: the generator places the phases so that peaks are lower than by
// chance.
motion::MotionTrajectory loudest(const Design& design, const Bounds& bounds) {
  constexpr double kSoft_m_s2 = 0.01;
  motion::MotionTrajectory best = generated(design, bounds, kSoft_m_s2);
  const motion::MotionReport& soft = best.report();
  const double times =
      kMargin * std::min({kMargin * bounds.ride.peak_m_s2 / soft.table_peak_m_s2,
                          kMargin * bounds.limits.max_velocity_m_s / soft.peak_velocity_m_s,
                          kMargin * bounds.limits.max_position_m / soft.peak_position_m});
  for (const double louder : {1.6, 1.3, 1.0}) {
    try {
      return generated(design, bounds, kSoft_m_s2 * times * louder);
    } catch (const ConfigError&) {  // the limits do not allow it
    }
  }
  return best;
}

std::vector<double> sampled(const motion::MotionTrajectory& motion, std::size_t count) {
  std::vector<double> accel;
  for (std::size_t n = 0; n < count; ++n) {
    const auto tick =
        static_cast<Tick>(std::llround(static_cast<double>(n) * kRideStep_s / kControlPeriod_s));
    accel.push_back(motion.at(motion.ramp_ticks() + tick).acceleration_m_s2);
  }
  return accel;
}

// A sine whose frequency grows as an exponential of time, as loud at each as the limits allow.
std::vector<double> sweep(const Design& design, const Bounds& bounds, std::size_t count) {
  std::vector<double> accel;
  const double length_s = static_cast<double>(count) * kRideStep_s;
  const double rate = std::log(design.high_hz / design.low_hz) / length_s;
  for (std::size_t n = 0; n < count; ++n) {
    const double t_s = static_cast<double>(n) * kRideStep_s;
    const double w_rad_s = 2.0 * std::numbers::pi * design.low_hz * std::exp(rate * t_s);
    const double phase_rad = (w_rad_s - 2.0 * std::numbers::pi * design.low_hz) / rate;
    const double most = std::min({bounds.ride.peak_m_s2, bounds.limits.max_velocity_m_s * w_rad_s,
                                  bounds.limits.max_position_m * w_rad_s * w_rad_s});
    accel.push_back(kMargin * most * std::sin(phase_rad));
  }
  return accel;
}

// 1 in a loud part, `quiet` in a quiet one, half a cosine of half a second between them.
double loudness(double t_s, double quiet) {
  constexpr double kChange_s = 0.5;
  const double place = std::fmod(t_s, 2.0 * kPart_s);
  const double since = place < kPart_s ? place : place - kPart_s;
  const double done = 0.5 - 0.5 * std::cos(std::numbers::pi * std::min(since / kChange_s, 1.0));
  const double from = place < kPart_s ? quiet : 1.0;
  const double to = place < kPart_s ? 1.0 : quiet;
  return t_s < kPart_s ? 1.0 : from + (to - from) * done;
}

// At Ride::kRate_hz, before level and loudness.
std::vector<double> loudest_of(const Design& design, const Bounds& bounds) {
  const std::size_t count = samples_of(bounds);
  return design.family == Family::kSweep ? sweep(design, bounds, count)
                                         : sampled(loudest(design, bounds), count);
}

Ride played(const Design& design, const std::vector<double>& loudest_m_s2, const Bounds& bounds) {
  Ride ride;
  ride.accel_m_s2 = loudest_m_s2;
  for (std::size_t n = 0; n < ride.accel_m_s2.size(); ++n) {
    ride.accel_m_s2[n] *=
        design.level * loudness(static_cast<double>(n) * kRideStep_s, design.quiet);
  }
  motion::MotionProfile profile = bounds.ride;
  profile.ride_rate_hz = Ride::kRate_hz;
  profile.ride_accel_m_s2 = ride.accel_m_s2;
  ride.motion = motion::MotionTrajectory(profile, bounds.limits);
  return ride;
}

// Designs whose loudest motion is the same.
bool same_motion(const Design& one, const Design& other) {
  const auto made_as = [](Family family) {
    return family == Family::kSteps ? Family::kNoise : family;
  };
  return made_as(one.family) == made_as(other.family) && one.low_hz == other.low_hz &&
         one.high_hz == other.high_hz && one.seed == other.seed;
}

// The loudest motion of each design; making it takes longer than all else.
std::vector<std::vector<double>> loudest_of(const std::vector<Design>& designs,
                                            const Bounds& bounds, const ForEach& for_each) {
  std::vector<std::size_t> first(designs.size());
  for (std::size_t d = 0; d < designs.size(); ++d) {
    while (!same_motion(designs[first[d]], designs[d])) ++first[d];
  }
  std::vector<std::vector<double>> loudest(designs.size());
  for_each(designs.size(), [&](std::size_t d) {
    if (first[d] != d) return;
    try {
      loudest[d] = loudest_of(designs[d], bounds);
    } catch (const ConfigError&) {
      loudest[d].clear();  // the band holds no harmonic
    }
  });
  for (std::size_t d = 0; d < designs.size(); ++d) loudest[d] = loudest[first[d]];
  return loudest;
}

using Band = std::pair<double, double>;

// The band of the recording, as far as the platform follows it.
Band band_of(const Contest& contest, const Bounds& bounds) {
  return {std::max(contest.band_hz().first, bounds.ride.band_low_hz),
          std::min(contest.band_hz().second, bounds.ride.band_high_hz)};
}

// The grid of Eq. NR-10: the band, its halves and thirds on a logarithmic axis.
std::vector<Design> first_designs(const Band& band) {
  const auto at = [&](double part) {
    return band.first * std::pow(band.second / band.first, part);
  };
  std::vector<Design> designs;
  for (const auto& [from, to] : {std::pair{0.0, 1.0},
                                 {0.0, 0.5},
                                 {0.5, 1.0},
                                 {0.0, 1.0 / 3.0},
                                 {1.0 / 3.0, 2.0 / 3.0},
                                 {2.0 / 3.0, 1.0}}) {
    for (const Family family :
         {Family::kNoise, Family::kMultisine, Family::kSweep, Family::kSteps}) {
      for (const double level : {1.0, 0.5, 0.25}) {
        designs.push_back(
            {family, at(from), at(to), level, family == Family::kSteps ? 0.2 : 1.0, 1});
      }
    }
  }
  return designs;
}

std::vector<Design> around(const Design& best, const Band& band, std::uint64_t seed) {
  constexpr double kStep = 1.3;
  std::vector<Design> designs;
  const auto add = [&](auto&& change) {
    Design other = best;
    change(other);
    other.low_hz = std::max(other.low_hz, band.first);
    other.high_hz = std::min(other.high_hz, band.second);
    if (other.low_hz * 1.1 < other.high_hz) designs.push_back(other);
  };
  add([&](Design& d) { d.low_hz *= kStep; });
  add([&](Design& d) { d.low_hz /= kStep; });
  add([&](Design& d) { d.high_hz *= kStep; });
  add([&](Design& d) { d.high_hz /= kStep; });
  add([&](Design& d) { d.level *= 0.7; });
  add([&](Design& d) { d.seed = seed; });
  add([&](Design& d) { d.seed = seed + 1; });
  if (best.family == Family::kSteps) {
    add([&](Design& d) { d.quiet *= 0.5; });
    add([&](Design& d) { d.quiet = std::min(1.0, 2.0 * d.quiet); });
  }
  return designs;
}

struct Tried {
  Design design;
  MatrixXd margin;       // of each pair, Eq. NR-6; empty: the limits do not allow it
  double reach = 0.0;    // Eq. NR-11
  double settled = 0.0;  // Eq. NR-7
};

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

// Eq. NR-11: the largest force that a candidate predicts.
double reach_of(const Contest& contest, const Measurement& run) {
  double reach = 0.0;
  for (std::size_t i = 0; i < contest.candidates().size(); ++i) {
    reach = std::max(reach, largest(contest.prediction(i, run)));
  }
  return reach;
}

std::vector<Tried> tried(const std::vector<Design>& designs, const Contest& contest,
                         const Measurement& recorded, const Bounds& bounds,
                         const ForEach& for_each) {
  const diagnosis::Model& model = contest.candidates().front().model;
  std::vector<Tried> all(designs.size());
  const std::vector<std::vector<double>> loudest = loudest_of(designs, bounds, for_each);
  for_each(designs.size(), [&](std::size_t d) {
    all[d].design = designs[d];
    if (loudest[d].empty()) return;
    try {
      const Ride ride = played(designs[d], loudest[d], bounds);
      const Measurement run = run_of(ride.motion, recorded, model.inputs.front(), model.output);
      const Expected expected = contest.expected(run, 0);
      all[d].margin = contest.margin(expected);
      all[d].settled = contest.probability_settled(expected);
      all[d].reach = reach_of(contest, run);
    } catch (const ConfigError&) {  // the limits do not allow it
    }
  });
  std::erase_if(all, [](const Tried& each) { return each.margin.size() == 0; });
  return all;
}

// The least over the pairs that any motion of the grid can tell apart; where there is none, over
// all.
double least(const MatrixXd& margin, const MatrixXd& most) {
  double least = HUGE_VAL;
  for (Index i = 0; i < margin.rows(); ++i) {
    for (Index j = 0; j < margin.cols(); ++j) {
      if (i != j && most(i, j) >= kHopeless) least = std::min(least, margin(i, j));
    }
  }
  return std::isfinite(least) ? least : margin.sum();
}

MatrixXd greatest(const std::vector<Tried>& all) {
  MatrixXd most = all.front().margin;
  for (const Tried& each : all) most = most.cwiseMax(each.margin);
  return most;
}

}  // namespace

std::string in_words(Family family) {
  constexpr std::array kWords{"band noise", "multisine", "sweep", "loud and quiet"};
  return kWords.at(static_cast<std::size_t>(family));
}

Ride ride_of(const Design& design, const Bounds& bounds) {
  return played(design, loudest_of(design, bounds), bounds);
}

Measurement run_of(const motion::MotionTrajectory& motion, const Measurement& recorded,
                   const std::string& input, const std::string& output) {
  const double length_s = static_cast<double>(motion.duration_ticks()) * kControlPeriod_s;
  const auto count = static_cast<std::size_t>(length_s * recorded.rate_hz);
  const Stretch& stretch = *std::ranges::max_element(
      recorded.stretches, {}, [](const Stretch& s) { return s.end - s.first; });
  Measurement run;
  run.source = "the planned run";
  run.rate_hz = recorded.rate_hz;
  run.stretches = {{0, count, 0.0, 0}};
  run.weight.assign(count, 1.0);
  for (const diagnosis::Channel& channel : recorded.channels) {
    diagnosis::Channel& planned =
        run.channels.emplace_back(diagnosis::Channel{channel.name, channel.unit, {}});
    planned.values.assign(count, 0.0);
    if (channel.name == output) continue;
    for (std::size_t n = 0; n < count; ++n) {
      const double tick = static_cast<double>(n) / recorded.rate_hz / kControlPeriod_s;
      planned.values[n] =
          channel.name == input
              ? motion.at(motion.ramp_ticks() + std::llround(tick)).acceleration_m_s2
              : channel.values[stretch.first + n % (stretch.end - stretch.first)];
    }
  }
  return run;
}

Plan best_plan(const Contest& contest, const Measurement& recorded, const Bounds& bounds,
               const ForEach& for_each) {
  constexpr int kRounds = 2;
  constexpr int kSteps = 8;
  constexpr double kEnough = 0.95;
  const Band band = band_of(contest, bounds);
  std::vector<Tried> all = tried(first_designs(band), contest, recorded, bounds, for_each);
  if (all.empty()) {
    throw ConfigError("--seconds", "no motion of that length within the platform's limits",
                      "a longer run, or wider limits in motion.yaml");
  }
  const MatrixXd most = greatest(all);
  // Eq. NR-11: beyond what the recording showed, models are less certain than their numbers say.
  const auto best_of = [&] {
    return std::ranges::max_element(all, {}, [&](const Tried& t) {
      const bool enough = t.settled >= kEnough;
      return std::pair(enough, enough ? -t.reach : least(t.margin, most));
    });
  };
  for (int round = 0; round < kRounds; ++round) {
    const auto seed = 2 + 2 * static_cast<std::uint64_t>(round);
    std::vector<Tried> more =
        tried(around(best_of()->design, band, seed), contest, recorded, bounds, for_each);
    all.insert(all.end(), std::make_move_iterator(more.begin()),
               std::make_move_iterator(more.end()));
  }
  const diagnosis::Model& model = contest.candidates().front().model;
  Plan plan;
  plan.design = best_of()->design;
  plan.tried = all.size();
  plan.best_margin = greatest(all);
  plan.ride = ride_of(plan.design, bounds);
  plan.run = run_of(plan.ride.motion, recorded, model.inputs.front(), model.output);
  plan.expected = contest.expected(plan.run, kSteps);
  plan.chance = contest.chance(plan.expected);
  plan.probability_settled = contest.probability_settled(plan.expected);
  plan.probability_repeated = contest.probability_settled(
      // No channel is of the plan: the recorded motion for as long.
      contest.expected(run_of(plan.ride.motion, recorded, "", model.output), kSteps));
  return plan;
}

std::vector<Lasting> longer(const Plan& plan, const std::vector<double>& seconds,
                            const Contest& contest, const Measurement& recorded,
                            const Bounds& bounds) {
  const diagnosis::Model& model = contest.candidates().front().model;
  std::vector<Lasting> all;
  for (const double each : seconds) {
    Bounds longer = bounds;
    longer.ride.duration_ticks = ticks_in(each);
    const Ride ride = ride_of(plan.design, longer);
    const Measurement run = run_of(ride.motion, recorded, model.inputs.front(), model.output);
    all.push_back({each, contest.probability_settled(contest.expected(run, 0))});
  }
  return all;
}

}  // namespace stillhand::next_run

// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/protocol.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <random>
#include <sstream>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/motion/excitation.hpp"

namespace stillhand::session {
namespace {

using motion::MotionKind;

// Every use of the session's seed has a stream of its own.
enum class SeedUse : std::uint32_t { kOrder = 1, kReference = 2, kMotion = 3, kRepeat = 4 };

std::uint64_t derived_seed(std::uint64_t seed, SeedUse use, std::int64_t trial) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    static_cast<std::uint32_t>(use), static_cast<std::uint32_t>(trial)};
  std::uint32_t word = 0;
  mix.generate(&word, &word + 1);
  return word;
}

void check_duration(const char* key, double value_s) {
  if (!(value_s >= 5.0 && value_s <= 3600.0)) {
    throw ConfigError(key, fmt::format("{}", value_s), "5 to 3600 seconds");
  }
}

// Frequencies that the platform may use for a road or a ride: a ride's high-pass starts at the
// lowest, and the platform follows to 6 Hz (paper III-C).
constexpr double kLowest_hz = 0.05;
constexpr double kHighest_hz = 6.0;

void check_road(const ProtocolOptions& options) {
  if (options.road_class.size() != 1 || options.road_class[0] < 'A' ||
      options.road_class[0] > 'H') {
    throw ConfigError("--road-class", fmt::format("\"{}\"", options.road_class),
                      "A (very good) to H");
  }
  if (!(options.road_speed_m_s >= 0.5 && options.road_speed_m_s <= 70.0)) {
    throw ConfigError("--speed-m-s", fmt::format("{}", options.road_speed_m_s), "0.5 to 70 m/s");
  }
}

// It keeps its own intensity.
void set_ride(PlannedTrial& planned) {
  planned.motion = MotionKind::kRide;
  planned.band_low_hz = kLowest_hz;
  planned.band_high_hz = kHighest_hz;
  planned.band_order = 0;
  planned.rms_m_s2 = 0.0;
}

// Band and intensity of the motion in B and C.
void set_tracking_motion(PlannedTrial& planned, const ProtocolOptions& options) {
  planned.motion = options.motion;
  planned.peak_m_s2 = 7.5;
  switch (options.motion) {
    case MotionKind::kBandNoise:  // paper III-C
      planned.band_low_hz = 0.7;
      planned.band_high_hz = 2.0;
      planned.rms_m_s2 = 1.6;
      return;
    case MotionKind::kRoad: {
      // The speed turns the road's wavelengths into frequencies: a slow vehicle meets no high ones,
      // a fast one no low ones.
      const Range described_hz = motion::road_band_hz(options.road_speed_m_s);
      planned.band_low_hz = std::max(kLowest_hz, described_hz.min);
      planned.band_high_hz = std::min(kHighest_hz, described_hz.max);
      break;
    }
    case MotionKind::kStill:
    case MotionKind::kRide:
    case MotionKind::kMultisine:
      planned.band_low_hz = kLowest_hz;
      planned.band_high_hz = kHighest_hz;
      break;
  }
  planned.rms_m_s2 = 0.0;  // a road and a ride keep their own
}

}  // namespace

bool drives_motor(const PlannedTrial& planned) {
  return planned.cancellation || cancellation::drives_motor(planned.parts);
}

bool opposes_feedthrough(const PlannedTrial& planned) {
  return planned.cancellation || cancellation::opposes_feedthrough(planned.parts);
}

std::string check_seed(const std::string& word) {
  std::int64_t seed = -1;
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, seed);
  if (error == std::errc() && rest == end && seed >= 0) return {};
  return fmt::format("got {}, want a whole number from 0 to {}", word,
                     std::numeric_limits<std::int64_t>::max());
}

std::string known_conditions(Where where) {
  std::vector<std::string> known;
  if (where == kMitigations) known.emplace_back("all");
  for (const Condition each : conditions_of(where)) {
    known.push_back(where == kMitigations ? mitigation_name(each) : title_of(each, " (", ")"));
  }
  return fmt::format("{}", fmt::join(known, ", "));
}

std::vector<Condition> parse_conditions(const std::string& text, Where where, const char* option) {
  std::vector<Condition> conditions;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const std::optional<Condition> condition = condition_named(word);
    if (!condition || (row_of(*condition).where & where) == 0) {
      throw ConfigError(option, fmt::format("\"{}\"", word),
                        "a list of " + known_conditions(where));
    }
    if (std::ranges::find(conditions, *condition) != conditions.end()) {
      const bool alias = word == row_of(*condition).alias;
      throw ConfigError(
          option, word + " twice",
          alias ? "each condition once; none is B, and force is C" : "each condition once");
    }
    conditions.push_back(*condition);
  }
  if (conditions.empty()) throw ConfigError(option, "nothing", "for example A,B,C");
  return conditions;
}

PlannedTrial identification_trial(const ProtocolOptions& options) {
  PlannedTrial planned{};
  planned.trial.number = 0;
  planned.trial.phase = TrialPhase::kPegged;
  planned.trial.duration_ticks = ticks_in(options.identify_s);
  planned.trial.ramp_ticks = ticks_in(options.ramp_s);
  planned.label = Condition::kIdentification;
  planned.moving = true;
  planned.motion = MotionKind::kBandNoise;  // white noise whatever the trials use: paper III-A
  planned.band_low_hz = 0.7;
  planned.band_high_hz = 4.0;
  // "Band-pass filtered" in the paper, whose Fig. 4 has its estimate to 10 Hz: the filter lets some
  // power through beyond 4 Hz, or the notch at 6 Hz could not be seen.  Its order isn't given.
  planned.band_order = 4;
  // Peak 0.75 g (paper III-A); a random phase noise of 40 to 120 s peaks near 3.8 times its RMS, so
  // that this RMS just fits under it.
  planned.peak_m_s2 = 0.75 * kGravity_m_s2;
  planned.rms_m_s2 = planned.peak_m_s2 / 3.8;
  planned.motion_seed = derived_seed(options.seed, SeedUse::kMotion, 0);
  if (options.planned) set_ride(planned);
  return planned;
}

PlannedTrial identification_again(const ProtocolOptions& options, std::int64_t number) {
  PlannedTrial planned = identification_trial(options);
  planned.trial.number = number;
  planned.motion_seed = derived_seed(options.seed, SeedUse::kMotion, number);
  return planned;
}

PlannedTrial free_identification_trial(const ProtocolOptions& options, std::int64_t number) {
  PlannedTrial planned = identification_again(options, number);
  planned.trial.phase = TrialPhase::kFree;
  planned.label = Condition::kFreeIdentification;
  return planned;
}

PlannedTrial tracking_trial(const ProtocolOptions& options, Condition condition,
                            std::int64_t number) {
  PlannedTrial planned{};
  planned.trial.number = number;
  planned.trial.phase = TrialPhase::kTracking;
  planned.trial.duration_ticks = ticks_in(options.trial_s);
  planned.trial.ramp_ticks = ticks_in(options.ramp_s);
  planned.reference_seed = derived_seed(options.seed, SeedUse::kReference, number);
  planned.label = condition;
  planned.moving = condition != Condition::kA;
  ProtocolOptions own = options;
  if (condition == Condition::kP) own.motion = MotionKind::kMultisine;
  set_tracking_motion(planned, own);
  planned.motion_seed = derived_seed(options.seed, SeedUse::kMotion, number);
  const ConditionRow& row = row_of(condition);
  planned.cancellation = row.means == Means::kCanceller;
  if (condition == Condition::kP && options.stick_held) {
    planned.trial.phase = TrialPhase::kPegged;
    planned.cancellation = false;
  }
  planned.command_filter = row.means == Means::kCommandFilter;
  if (row.means != Means::kMitigation) return planned;
  planned.parts = row.parts;
  for (cancellation::Part& part : planned.parts) {
    if (part.kind == cancellation::PartKind::kSchedule) part.values = options.arms;
  }
  return planned;
}

std::vector<PlannedTrial> plan(const ProtocolOptions& options) {
  check_duration("--trial-seconds", options.trial_s);
  check_duration("--identify-seconds", options.identify_s);
  if (options.motion == MotionKind::kRoad) check_road(options);
  std::vector<Condition> order = options.conditions;
  std::mt19937_64 engine(derived_seed(options.seed, SeedUse::kOrder, 0));
  std::shuffle(order.begin(), order.end(), engine);

  std::vector<PlannedTrial> trials{identification_trial(options)};
  if (std::ranges::any_of(order, needs_position)) {
    trials.push_back(free_identification_trial(options, 1));
  }
  for (const Condition condition : order) {
    const auto number = static_cast<std::int64_t>(trials.size());
    trials.push_back(tracking_trial(options, condition, number));
  }
  return trials;
}

std::uint64_t repeat_seed(std::uint64_t seed, std::uint64_t repeat) {
  return derived_seed(seed, SeedUse::kRepeat, static_cast<std::int64_t>(repeat));
}

motion::MotionProfile motion_profile(const PlannedTrial& planned) {
  motion::MotionProfile profile;
  if (planned.moving) profile.kind = planned.motion;
  profile.band_low_hz = planned.band_low_hz;
  profile.band_high_hz = planned.band_high_hz;
  profile.band_order = planned.band_order;
  profile.rms_m_s2 = planned.rms_m_s2;
  profile.peak_m_s2 = planned.peak_m_s2;
  profile.seed = planned.motion_seed;
  profile.duration_ticks = planned.trial.duration_ticks;
  profile.ramp_ticks = planned.trial.ramp_ticks;
  return profile;
}

}  // namespace stillhand::session

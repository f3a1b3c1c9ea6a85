// SPDX-License-Identifier: Apache-2.0
#include "experiment/protocol.hpp"

#include <algorithm>
#include <random>
#include <sstream>

#include "contract/config_error.hpp"

namespace stillhand::experiment {
namespace {

// Streams of the session's seed; each use has its own.
enum class SeedUse : std::uint32_t { kOrder = 1, kReference = 2, kMotion = 3 };

std::uint64_t derived_seed(std::uint64_t seed, SeedUse use, std::int64_t trial) {
  std::seed_seq mix{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32),
                    static_cast<std::uint32_t>(use), static_cast<std::uint32_t>(trial)};
  std::uint32_t word = 0;
  mix.generate(&word, &word + 1);
  return word;
}

void check_duration(const char* key, double value_s) {
  if (!(value_s >= 5.0 && value_s <= 3600.0)) {
    std::ostringstream got;
    got << value_s;
    throw ConfigError(key, got.str(), "5 to 3600 seconds");
  }
}

PlannedTrial identification(const ProtocolOptions& options) {
  PlannedTrial planned{};
  planned.trial.number = 0;
  planned.trial.phase = TrialPhase::kPegged;
  planned.trial.duration_ticks = ticks_in(options.identify_s);
  planned.trial.ramp_ticks = ticks_in(options.ramp_s);
  planned.label = 'I';
  planned.moving = true;
  planned.motion = Motion::kBandNoise;  // white noise whatever the trials use: paper III-A
  planned.band_low_hz = 0.7;
  planned.band_high_hz = 4.0;
  // Peak 0.75 g (paper III-A); a random phase noise of 40 to 120 s peaks near 3.8 times its RMS, so
  // that this RMS just fits under it.
  planned.peak_m_s2 = 0.75 * 9.80665;
  planned.rms_m_s2 = planned.peak_m_s2 / 3.8;
  planned.motion_seed = derived_seed(options.seed, SeedUse::kMotion, 0);
  return planned;
}

}  // namespace

std::vector<Condition> parse_conditions(const std::string& text) {
  std::vector<Condition> conditions;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    if (word.size() != 1 || std::string("ABC").find(word) == std::string::npos) {
      throw ConfigError("--conditions", "\"" + word + "\"",
                        "a list of A (stationary), B (moving), C (moving, cancelled)");
    }
    const auto condition = static_cast<Condition>(word[0]);
    if (std::find(conditions.begin(), conditions.end(), condition) != conditions.end()) {
      throw ConfigError("--conditions", word + " twice", "each condition once");
    }
    conditions.push_back(condition);
  }
  if (conditions.empty()) throw ConfigError("--conditions", "nothing", "for example A,B,C");
  return conditions;
}

std::vector<PlannedTrial> plan(const ProtocolOptions& options) {
  check_duration("--trial-seconds", options.trial_s);
  check_duration("--identify-seconds", options.identify_s);
  std::vector<Condition> order = options.conditions;
  std::mt19937_64 engine(derived_seed(options.seed, SeedUse::kOrder, 0));
  std::shuffle(order.begin(), order.end(), engine);

  std::vector<PlannedTrial> trials{identification(options)};
  for (const Condition condition : order) {
    PlannedTrial planned{};
    planned.trial.number = static_cast<std::int64_t>(trials.size());
    planned.trial.phase = TrialPhase::kTracking;
    planned.trial.duration_ticks = ticks_in(options.trial_s);
    planned.trial.ramp_ticks = ticks_in(options.ramp_s);
    planned.reference_seed = derived_seed(options.seed, SeedUse::kReference, planned.trial.number);
    planned.label = static_cast<char>(condition);
    planned.moving = condition != Condition::kStationary;
    planned.motion = options.motion;
    const bool noise = options.motion == Motion::kBandNoise;
    planned.band_low_hz = noise ? 0.7 : 0.05;  // paper III-C; a ride's high-pass starts there
    planned.band_high_hz = noise ? 2.0 : 6.0;  // paper III-C; the platform follows to 6 Hz
    planned.rms_m_s2 = noise ? 1.6 : 0.0;      // others keep their own
    planned.peak_m_s2 = 7.5;
    planned.motion_seed = derived_seed(options.seed, SeedUse::kMotion, planned.trial.number);
    planned.cancellation = condition == Condition::kMovingCancelled;
    trials.push_back(planned);
  }
  return trials;
}

}  // namespace stillhand::experiment

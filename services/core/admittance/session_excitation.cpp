// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/session_excitation.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <string_view>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::admittance {
namespace {

constexpr std::int64_t kMostLines = 20;
constexpr double kLowest_hz = 0.05;
constexpr std::string_view kBeforePeriod = "interleaved multisines: period ";
constexpr std::string_view kBeforeSeed = " s, seed ";
constexpr std::string_view kSwapped = ", lines swapped";
constexpr std::int64_t kFewestSentPeriods = 5;  // four to analyse, after one that is left out

}  // namespace

ExcitationConfig session_excitation(const SessionPerturbation& perturbation) {
  if (!(perturbation.period_s >= 2.0 && perturbation.period_s <= 200.0)) {
    throw ConfigError("perturbation.period_s", std::to_string(perturbation.period_s), "2 to 200 s");
  }
  ExcitationConfig config;
  config.period_s = perturbation.period_s;
  config.lowest_hz = std::max(kLowest_hz, 1.0 / perturbation.period_s);
  config.seed = static_cast<std::int64_t>(perturbation.seed);
  config.swapped = perturbation.swapped;
  for (config.lines = kMostLines; config.lines > 2; --config.lines) {
    try {
      interleaved_harmonics(config);
      break;
    } catch (const ConfigError&) {
      continue;  // no room for so many
    }
  }
  interleaved_harmonics(config);
  return config;
}

std::vector<signal::Component> motion_components(const SessionPerturbation& perturbation,
                                                 std::int64_t duration_ticks) {
  const Excitation excitation = design(session_excitation(perturbation));
  const std::int64_t period = excitation.motion.samples_per_period();
  if (duration_ticks % period != 0 || duration_ticks / period < kFewestSentPeriods) {
    throw ConfigError("perturbation.period_s", std::to_string(perturbation.period_s),
                      "a trial of whole periods, five or more; " + std::to_string(duration_ticks) +
                          " ticks are none");
  }
  std::vector<signal::Component> out = excitation.motion.components();
  for (signal::Component& component : out) component.harmonic *= duration_ticks / period;
  return out;
}

std::string in_words(const SessionPerturbation& perturbation) {
  std::array<char, 120> text{};
  std::snprintf(text.data(), text.size(), "%s%.17g%s%" PRIu64 "%s", kBeforePeriod.data(),
                perturbation.period_s, kBeforeSeed.data(), perturbation.seed,
                perturbation.swapped ? kSwapped.data() : "");
  return text.data();
}

SessionPerturbation perturbation_in(const std::string& words) {
  SessionPerturbation out;
  const char* const end = words.data() + words.size();
  if (!words.starts_with(kBeforePeriod)) return {};
  const auto period = std::from_chars(words.data() + kBeforePeriod.size(), end, out.period_s);
  const std::string_view rest(period.ptr, static_cast<std::size_t>(end - period.ptr));
  if (period.ec != std::errc() || !rest.starts_with(kBeforeSeed)) return {};
  const auto seed = std::from_chars(rest.data() + kBeforeSeed.size(), end, out.seed);
  if (seed.ec != std::errc()) return {};
  const std::string_view last(seed.ptr, static_cast<std::size_t>(end - seed.ptr));
  out.swapped = last == kSwapped;
  return out.swapped || last.empty() ? out : SessionPerturbation{};
}

}  // namespace stillhand::admittance

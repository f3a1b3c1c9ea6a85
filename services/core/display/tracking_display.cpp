// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/tracking_display.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "services/core/contract/config_error.hpp"
#include "services/core/signal/smooth_step.hpp"

namespace stillhand::display {
namespace {

/// Draws before giving up.  With the default scale and 180 s 3 % fit (of 2000 seeds): that 2000
/// fail in a row has a chance of 0.97^2000 = 4e-27.
constexpr int kMostDraws = 2000;
/// Odd constant of Weyl's sequence (2^64 / golden ratio): seeds of successive draws all differ.
constexpr std::uint64_t kNextSeed = 0x9e3779b97f4a7c15u;

const TrackingDisplay::Config& checked(const TrackingDisplay::Config& config) {
  validate(config, "display");
  ScreenLayout(config.screen, config.box_width_m);  // throws what validate() cannot see
  return config;
}

void check(const Trial& trial) {
  if (trial.sound()) return;
  throw ConfigError("display.trial", "a start at " + std::to_string(trial.start_tick),
                    "start, length and ramps of 0 to 2^60 ticks");
}

}  // namespace

signal::ReferenceSignal reference_on_screen(const TrackingDisplay::Config& config,
                                            Tick duration_ticks, std::uint64_t seed) {
  const auto set =
      config.coprime_reference ? signal::ReferenceSet::kCoprime : signal::ReferenceSet::kPaper;
  const auto design =
      signal::reference_design(static_cast<double>(duration_ticks) * kControlPeriod_s, set);
  const double limit_m =
      config.screen.width_m / 2.0 - config.box_width_m / 2.0 - config.screen.line_width_m / 2.0;
  // Four samples a cycle of the fastest line find nearly every misfit at a hundredth of the cost;
  // the full table has the last word.
  const Tick coarse_ticks = std::min(duration_ticks, 4 * design.harmonics.back());
  for (int draw = 0; draw < kMostDraws; ++draw, seed += kNextSeed) {
    const double scale_m = config.reference_scale_m;
    const signal::ReferenceSignal coarse(design, coarse_ticks, seed, scale_m);
    if (coarse.peak_m() > limit_m) continue;
    signal::ReferenceSignal reference(design, duration_ticks, seed, scale_m);
    if (reference.peak_m() <= limit_m) return reference;
  }
  throw ConfigError(
      "display.reference_scale_m", std::to_string(config.reference_scale_m),
      "a smaller scale: in " +
          std::to_string(static_cast<double>(duration_ticks) * kControlPeriod_s) +
          " s the target's box leaves the screen with every draw of phases (a trial of a whole "
          "multiple of 180 s allows the largest scale)");
}

TrackingDisplay::TrackingDisplay(const Config& config) : config_(checked(config)) {}

void TrackingDisplay::arm(signal::ReferenceSignal&& reference, const Trial& trial) {
  check(trial);
  if (reference_) {
    std::swap(*reference_, reference);
  } else {
    reference_ = std::move(reference);
  }
  trial_ = trial;
}

void TrackingDisplay::arm(const Trial& trial, std::uint64_t reference_seed) {
  if (trial.phase == TrialPhase::kTracking) {
    arm(reference_on_screen(config_, trial.duration_ticks, reference_seed), trial);
  } else {
    check(trial);
    reference_.reset();
    trial_ = trial;
  }
}

double TrackingDisplay::target_at(Tick tick) const noexcept {
  if (!reference_ || !trial_.covers(tick)) return 0.0;
  const double target_m = reference_->at(tick - trial_.start_tick);
  if (trial_.measures(tick)) return target_m;
  const Tick away = tick < trial_.start_tick
                        ? trial_.start_tick - tick
                        : tick - (trial_.start_tick + trial_.duration_ticks) + 1;
  // away runs from 1 next to the measured part to ramp_ticks at the far end.
  const double u = 1.0 - static_cast<double>(away) / static_cast<double>(trial_.ramp_ticks + 1);
  return signal::smooth_step(u) * target_m;
}

TrackingSample TrackingDisplay::step(const TrackingInput& input) noexcept {
  Flags flags = kGood;
  if (last_tick_ >= 0 && input.tick > last_tick_ + 1) flags |= kInputGap;
  last_tick_ = input.tick;
  const double target_m = target_at(input.tick);
  const bool known = std::isfinite(input.theta_rad);
  if (known) {
    cursor_m_ = config_.gain_m_rad * (input.theta_rad - input.taken_off_rad);
  } else {
    flags |= kInputInvalid;
  }
  const bool inside = known && std::abs(cursor_m_ - target_m) < config_.box_width_m / 2.0;
  return {target_m, cursor_m_, inside, flags};
}

}  // namespace stillhand::display

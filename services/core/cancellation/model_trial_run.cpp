// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/model_trial_run.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/model_strength.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

// 1 + sum (d_i - slope * path_i) q^-i.
signal::DifferenceModel closed(const ControlModel& model, double slope) {
  const LoopPath& loop = *model.loop;
  const std::vector<double>& path = loop.n.empty() ? loop.e : loop.m;
  signal::DifferenceModel out{model.rate_hz, model.denominator, model.denominator};
  for (std::size_t i = 1; i < path.size(); ++i) out.denominator[i] -= slope * path[i];
  return out;
}

// A swept sinusoid of the motion's greatest acceleration (paper III-C), then nothing.  A spring
// with memory may hold a force behind it (check_strength() bounds it), but it does not swing.
bool trial_run_dies_away(const ControlModel& model, std::int64_t settle,
                         const ModelBounds& bounds) {
  constexpr double kAccel_m_s2 = 7.5;
  constexpr double kLow_hz = 0.3;
  constexpr double kHigh_hz = 12.0;
  constexpr Tick kSwept = 10'000;
  constexpr double kSmall = 0.05;  // of the largest force
  ControlModel alone = model;
  alone.paths.clear();
  alone.waves.clear();
  std::erase_if(alone.hysteresis, [](const Hysteresis& each) { return each.path.has_value(); });
  const bool holds = !alone.hysteresis.empty();
  ControlModelFilter filter(alone, settle);
  const double bound_n = 2.0 * bounds.max_gain_n_s2_m * kAccel_m_s2;
  double turn = 0.0;
  double most_n = 0.0;
  double least_last_n = HUGE_VAL;
  double most_last_n = -HUGE_VAL;
  const Tick quiet = std::max<Tick>(2 * settle, 2'000);
  for (Tick tick = 0; tick < kSwept + quiet; ++tick) {
    const double along = static_cast<double>(tick) / static_cast<double>(kSwept);
    turn +=
        2.0 * std::numbers::pi * kLow_hz * std::pow(kHigh_hz / kLow_hz, along) * kControlPeriod_s;
    ChannelSample sample{};
    const double accel = tick < kSwept ? kAccel_m_s2 * std::sin(turn) : 0.0;
    sample[static_cast<std::size_t>(Channel::kAccelY)] = accel;
    const double force_n = filter.step(sample, tick).feedthrough_n;
    if (!(std::abs(force_n) <= bound_n)) return false;
    most_n = std::max(most_n, std::abs(force_n));
    if (tick < kSwept + quiet - 500) continue;
    least_last_n = std::min(least_last_n, force_n);
    most_last_n = std::max(most_last_n, force_n);
  }
  const double left_n =
      holds ? most_last_n - least_last_n : std::max(std::abs(least_last_n), std::abs(most_last_n));
  return left_n <= kSmall * most_n;
}

}  // namespace

bool rests(const ControlModel& model, std::int64_t settle) {
  ControlModel still = model;
  still.waves.clear();
  ControlModelFilter filter(still, settle);
  ControlModelFilter::Force force{};
  for (Tick tick = 0; tick < 2 * settle + 10; ++tick) force = filter.step(ChannelSample{}, tick);
  return std::abs(force.feedthrough_n) + std::abs(force.beside_n) <= kMaxRest_n;
}

Refusal check_loop(const ControlModel& model, std::int64_t settle, const ModelBounds& bounds) {
  if (!model.loop) return Refusal::kNone;
  const Slopes slopes = slopes_of(model.loop->phi, hysteresis_of(model, {}));
  for (const double slope : {slopes.least, 0.5 * (slopes.least + slopes.most), slopes.most}) {
    const signal::DifferenceModel with = closed(model, slope);
    const bool finite =
        std::ranges::all_of(with.denominator, [](double d) { return std::isfinite(d); });
    if (!finite || !signal::is_stable(with)) return Refusal::kLoop;
    for (const std::complex<double>& pole : signal::poles(with)) {
      if (!(std::abs(pole) < 1.0)) return Refusal::kLoop;
    }
  }
  return trial_run_dies_away(model, settle, bounds) ? Refusal::kNone : Refusal::kLoop;
}

}  // namespace stillhand::cancellation

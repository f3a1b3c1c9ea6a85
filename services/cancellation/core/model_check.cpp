// SPDX-License-Identifier: Apache-2.0
#include "services/cancellation/core/model_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <exception>
#include <numbers>
#include <span>
#include <vector>

#include "services/cancellation/core/control_model_filter.hpp"
#include "services/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

bool finite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
}

bool finite(const ValueMap& map) {
  return std::isfinite(map.low) && std::isfinite(map.high) && finite(map.values);
}

bool finite(const ControlModel& model) {
  const auto input = [](const InputPath& each) {
    return finite(each.map) && finite(each.numerator);
  };
  const auto path = [](const DirectPath& each) {
    return finite(each.map) && finite(std::array{each.lag_s, each.gain});
  };
  const auto wave = [](const Wave& each) {
    return finite(std::array{each.frequency, each.sine_n, each.cosine_n});
  };
  const auto loop = [](const LoopPath& each) {
    return finite(each.e) && finite(each.n) && finite(each.m) && finite(each.phi);
  };
  const auto hand = [](const HandCompliance& each) {
    return finite(std::array{each.mass_kg, each.damping_n_s_m, each.stiffness_n_m, each.lever_m});
  };
  return finite(model.denominator) && finite(model.output) &&
         std::ranges::all_of(model.inputs, input) && std::ranges::all_of(model.paths, path) &&
         std::ranges::all_of(model.waves, wave) && (!model.loop || loop(*model.loop)) &&
         (!model.adapts || hand(*model.adapts));
}

bool is_table(const ValueMap& map) {
  return map.values.empty() || (map.values.size() >= 2 && map.low < map.high);
}

bool is_channel(Channel channel) { return static_cast<std::size_t>(channel) < kChannels; }

bool well_formed(const ControlModel& model) {
  const std::size_t taps = model.denominator.size();
  if (taps == 0 || model.denominator[0] != 1.0 || model.inputs.empty()) return false;
  if (!is_table(model.output)) return false;
  const auto input = [taps](const InputPath& each) {
    return is_channel(each.channel) && each.numerator.size() == taps && is_table(each.map);
  };
  const auto path = [](const DirectPath& each) {
    return is_channel(each.channel) && is_table(each.map) && each.lag_s >= 0.0;
  };
  const auto wave = [](const Wave& each) {
    return (!each.channel || is_channel(*each.channel)) && each.frequency >= 0.0;
  };
  const auto loop = [taps](const LoopPath& each) {
    const bool inside = each.n.size() == taps && each.m.size() == taps && each.m[0] == 0.0;
    const bool of_output = each.n.empty() && each.m.empty() && !each.e.empty() && each.e[0] == 0.0;
    return each.e.size() == taps && (inside || of_output) && each.phi.values.size() >= 2 &&
           is_table(each.phi);
  };
  // The first input is the platform's lateral acceleration: what the gain is bounded for.
  return model.inputs[0].channel == Channel::kAccelY && std::ranges::all_of(model.inputs, input) &&
         std::ranges::all_of(model.paths, path) && std::ranges::all_of(model.waves, wave) &&
         (!model.loop || loop(*model.loop));
}

bool fits(const ControlModel& model) {
  const auto small = [](const ValueMap& map) {
    return map.values.size() <= ValueTable::kMostValues;
  };
  return small(model.output) && model.inputs.size() <= ControlModelFilter::kMostInputs &&
         model.paths.size() <= ControlModelFilter::kMostPaths &&
         model.waves.size() <= ControlModelFilter::kMostWaves &&
         std::ranges::all_of(model.inputs, [&](const auto& each) { return small(each.map); }) &&
         std::ranges::all_of(model.paths, [&](const auto& each) { return small(each.map); }) &&
         (!model.loop || small(model.loop->phi));
}

// Largest |H| found; NaN when any value isn't finite.
double peak_gain(const signal::DifferenceModel& model,
                 const std::vector<std::complex<double>>& poles) {
  double peak = 0.0;
  const auto look = [&](double frequency_hz) {
    const double gain = std::abs(signal::response_at(model, frequency_hz));
    if (!(gain <= peak)) peak = gain;
  };
  constexpr int kPoints = 400;
  look(0.0);
  for (int i = 0; i <= kPoints && std::isfinite(peak); ++i) {
    // From 0.01 Hz up, evenly in log frequency: 85 a decade.
    look(0.01 * std::pow(0.5 * kControlRateHz / 0.01, static_cast<double>(i) / kPoints));
  }
  for (const std::complex<double>& pole : poles) {
    if (!std::isfinite(peak)) break;
    look(std::abs(std::arg(pole)) * kControlRateHz / (2.0 * std::numbers::pi));
  }
  return peak;
}

// Ticks until radius^n = 0.01, for every pole; above the limit when a pole is at or beyond 1.
std::int64_t settle_ticks(const std::vector<std::complex<double>>& poles) {
  std::int64_t slowest = 1;
  for (const std::complex<double>& pole : poles) {
    const double radius = std::abs(pole);
    if (!(radius < 1.0)) return kMaxSettle_ticks + 1;
    if (radius < 1e-6) continue;
    const double ticks = std::ceil(std::log(0.01) / std::log(radius));
    if (!(ticks <= static_cast<double>(kMaxSettle_ticks))) return kMaxSettle_ticks + 1;
    slowest = std::max(slowest, static_cast<std::int64_t>(ticks));
  }
  return slowest;
}

struct Slopes {
  double least;
  double most;
  [[nodiscard]] double steepest() const { return std::max(std::abs(least), std::abs(most)); }
};

Slopes slopes_of(const ValueMap& map) {
  if (map.values.empty()) return {1.0, 1.0};
  const double step = (map.high - map.low) / static_cast<double>(map.values.size() - 1);
  Slopes slopes{HUGE_VAL, -HUGE_VAL};
  for (std::size_t i = 1; i < map.values.size(); ++i) {
    const double slope = (map.values[i] - map.values[i - 1]) / step;
    slopes.least = std::min(slopes.least, slope);
    slopes.most = std::max(slopes.most, slope);
  }
  return slopes;
}

double full_scale(Channel channel) {
  return kChannelFacts[static_cast<std::size_t>(channel)].full_scale;
}

// Largest force of a path beside the body, on its channel's whole range.
double greatest(const DirectPath& path) {
  const ValueTable map(path.map);
  constexpr int kPoints = 1000;
  double most = 0.0;
  for (int i = -kPoints; i <= kPoints; ++i) {
    const double value = map(full_scale(path.channel) * i / kPoints);
    most = std::max(most, std::abs(path.gain * value));
  }
  return most;
}

bool of_stick(Channel channel) { return channel == Channel::kTheta || channel == Channel::kOmega; }

// Largest |H| from a channel.  The platform's accelerations are alike, and its roll tips gravity
// over; what the stick tells is bounded by the force at its full scale.
double gain_bound(Channel channel, const ModelBounds& bounds) {
  constexpr double kGravity_m_s2 = 9.80665;
  if (of_stick(channel)) return bounds.max_path_force_n / full_scale(channel);
  return bounds.max_gain_n_s2_m * (channel == Channel::kRoll ? kGravity_m_s2 : 1.0);
}

// What a path may ask for at most, in the terms of gain_bound().
double gain_of(const DirectPath& path) {
  if (of_stick(path.channel)) return greatest(path) / full_scale(path.channel);
  return std::abs(path.gain) * slopes_of(path.map).steepest();
}

// Paths of one channel add up, and so do waves: what each may not ask for, all together may not.
Refusal check_strength(const ControlModel& model, const std::vector<std::complex<double>>& poles,
                       const ModelBounds& bounds) {
  const double behind = slopes_of(model.output).steepest();
  std::array<double, kChannels> gains{};
  for (const InputPath& input : model.inputs) {
    gains[static_cast<std::size_t>(input.channel)] +=
        peak_gain(path_model(model, input), poles) * slopes_of(input.map).steepest() * behind;
  }
  for (const DirectPath& path : model.paths) {
    gains[static_cast<std::size_t>(path.channel)] += gain_of(path);
  }
  // Written so that a NaN is refused, too.
  for (std::size_t i = 0; i < kChannels; ++i) {
    const auto channel = static_cast<Channel>(i);
    if (gains[i] <= gain_bound(channel, bounds)) continue;
    return channel == Channel::kAccelY ? Refusal::kGain : Refusal::kPath;
  }
  double waves_n = 0.0;
  for (const Wave& wave : model.waves) waves_n += std::hypot(wave.sine_n, wave.cosine_n);
  return waves_n <= bounds.max_path_force_n ? Refusal::kNone : Refusal::kPath;
}

// What the model asks for while nothing moves, once it has settled; waves are bounded elsewhere.
bool rests(const ControlModel& model, std::int64_t settle) {
  ControlModel still = model;
  still.waves.clear();
  ControlModelFilter filter(still, settle);
  ControlModelFilter::Force force{};
  for (Tick tick = 0; tick < 2 * settle + 10; ++tick) force = filter.step(ChannelSample{}, tick);
  return std::abs(force.feedthrough_n) + std::abs(force.beside_n) <= kMaxRest_n;
}

// 1 + sum (d_i - slope * path_i) q^-i.
signal::DifferenceModel closed(const ControlModel& model, double slope) {
  const LoopPath& loop = *model.loop;
  const std::vector<double>& path = loop.n.empty() ? loop.e : loop.m;
  signal::DifferenceModel out{model.rate_hz, model.denominator, model.denominator};
  for (std::size_t i = 1; i < path.size(); ++i) out.denominator[i] -= slope * path[i];
  return out;
}

// A swept sinusoid of the motion's greatest acceleration (paper III-C), then nothing.
bool trial_run_dies_away(const ControlModel& model, std::int64_t settle,
                         const ModelBounds& bounds) {
  constexpr double kAccel_m_s2 = 7.5;
  constexpr double kLow_hz = 0.3;
  constexpr double kHigh_hz = 12.0;
  constexpr Tick kSwept = 10'000;
  ControlModel alone = model;
  alone.paths.clear();
  alone.waves.clear();
  ControlModelFilter filter(alone, settle);
  const double bound_n = 2.0 * bounds.max_gain_n_s2_m * kAccel_m_s2;
  double turn = 0.0;
  double most_n = 0.0;
  double last_n = 0.0;
  const Tick quiet = std::max<Tick>(2 * settle, 2'000);
  for (Tick tick = 0; tick < kSwept + quiet; ++tick) {
    const double along = static_cast<double>(tick) / static_cast<double>(kSwept);
    turn +=
        2.0 * std::numbers::pi * kLow_hz * std::pow(kHigh_hz / kLow_hz, along) * kControlPeriod_s;
    ChannelSample sample{};
    const double accel = tick < kSwept ? kAccel_m_s2 * std::sin(turn) : 0.0;
    sample[static_cast<std::size_t>(Channel::kAccelY)] = accel;
    const double force_n = std::abs(filter.step(sample, tick).feedthrough_n);
    if (!(force_n <= bound_n)) return false;
    most_n = std::max(most_n, force_n);
    if (tick >= kSwept + quiet - 500) last_n = std::max(last_n, force_n);
  }
  return last_n <= 0.05 * most_n;
}

Refusal check_loop(const ControlModel& model, std::int64_t settle, const ModelBounds& bounds) {
  if (!model.loop) return Refusal::kNone;
  const Slopes slopes = slopes_of(model.loop->phi);
  for (const double slope : {slopes.least, 0.5 * (slopes.least + slopes.most), slopes.most}) {
    const signal::DifferenceModel with = closed(model, slope);
    if (!finite(with.denominator) || !signal::is_stable(with)) return Refusal::kLoop;
    for (const std::complex<double>& pole : signal::poles(with)) {
      if (!(std::abs(pole) < 1.0)) return Refusal::kLoop;
    }
  }
  return trial_run_dies_away(model, settle, bounds) ? Refusal::kNone : Refusal::kLoop;
}

bool is_hand(const HandCompliance& hand) {
  const double critical = 2.0 * std::sqrt(hand.mass_kg * hand.stiffness_n_m);
  return hand.mass_kg >= 0.1 && hand.mass_kg <= 10.0 && hand.stiffness_n_m >= 50.0 &&
         hand.stiffness_n_m <= 10'000.0 && hand.damping_n_s_m > 0.0 &&
         hand.damping_n_s_m < critical && hand.lever_m >= 0.02 && hand.lever_m <= 0.5;
}

ModelCheck checked(const ControlModel& model, const ModelBounds& bounds) {
  const auto refused = [](Refusal why) { return ModelCheck{why, 0}; };
  if (!fits(model)) return refused(Refusal::kTooMany);
  if (!finite(model)) return refused(Refusal::kNotFinite);
  if (!well_formed(model)) return refused(Refusal::kMalformed);
  if (model.rate_hz != kControlRateHz) return refused(Refusal::kWrongRate);
  if (model.denominator.size() - 1 > ControlModelFilter::kMaxOrder) return refused(Refusal::kOrder);
  const signal::DifferenceModel first = path_model(model, model.inputs[0]);
  if (!signal::is_stable(first)) return refused(Refusal::kUnstable);
  const std::vector<std::complex<double>> poles = signal::poles(first);
  for (const std::complex<double>& pole : poles) {
    if (!(std::abs(pole) < 1.0)) return refused(Refusal::kUnstable);
  }
  const std::int64_t settle = settle_ticks(poles);
  if (settle > kMaxSettle_ticks) return refused(Refusal::kSettling);
  if (const Refusal why = check_strength(model, poles, bounds); why != Refusal::kNone) {
    return refused(why);
  }
  if (const Refusal why = check_loop(model, settle, bounds); why != Refusal::kNone) {
    return refused(why);
  }
  if (!rests(model, settle)) return refused(Refusal::kRest);
  if (model.adapts && !is_hand(*model.adapts)) return refused(Refusal::kCompliance);
  return {Refusal::kNone, settle};
}

}  // namespace

std::string_view describe(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::kNone:
      return "model taken";
    case Refusal::kMalformed:
      return "model is empty, its sizes differ, its denominator doesn't start with 1, or a lag, a "
             "frequency or a table's ends are out of order";
    case Refusal::kNotFinite:
      return "a coefficient is not a finite number";
    case Refusal::kWrongRate:
      return "model is not at exactly 1000 Hz";
    case Refusal::kOrder:
      return "model order is above 12";
    case Refusal::kUnstable:
      return "a pole lies on or outside the unit circle";
    case Refusal::kSettling:
      return "model takes longer than 10 s to settle";
    case Refusal::kGain:
      return "model gain is above the bound";
    case Refusal::kTooMany:
      return "more than 4 inputs, 6 paths, 6 waves or 129 values in a table";
    case Refusal::kPath:
      return "a further channel, a path beside the body or a wave is stronger than its bound";
    case Refusal::kLoop:
      return "the spring inside the body isn't stable at all its slopes, or doesn't die away";
    case Refusal::kRest:
      return "model asks for a force while nothing moves";
    case Refusal::kCompliance:
      return "mass, damping, stiffness or lever of the hand are out of range";
  }
  return "unknown";
}

ModelCheck check_model(const ControlModel& model, const ModelBounds& bounds) noexcept {
  try {
    return checked(model, bounds);
  } catch (const std::exception&) {
    // Only memory can run out in there; the live path must not end for a model.
    return {Refusal::kMalformed, 0};
  }
}

}  // namespace stillhand::cancellation

// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/model_check.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <exception>
#include <numbers>
#include <span>
#include <vector>

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/model_strength.hpp"
#include "services/core/cancellation/value_table.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

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
  const auto memory = [](const Hysteresis& each) {
    // The argument in thresholds, too.
    return finite(std::array{each.threshold, each.low, each.high, each.low / each.threshold,
                             each.high / each.threshold});
  };
  const auto hand = [](const HandCompliance& each) {
    return finite(std::array{each.mass_kg, each.damping_n_s_m, each.stiffness_n_m, each.lever_m});
  };
  return finite(model.denominator) && finite(model.output) &&
         std::ranges::all_of(model.inputs, input) && std::ranges::all_of(model.paths, path) &&
         std::ranges::all_of(model.waves, wave) && (!model.loop || loop(*model.loop)) &&
         std::ranges::all_of(model.hysteresis, memory) && (!model.adapts || hand(*model.adapts));
}

bool is_table(const ValueMap& map) {
  return map.values.empty() || (map.values.size() >= 2 && map.low < map.high);
}

bool is_channel(Channel channel) { return static_cast<std::size_t>(channel) < kChannels; }

// Each element has a place, and no two have the same.
bool in_place(const ControlModel& model) {
  return std::ranges::all_of(model.hysteresis, [&](const Hysteresis& each) {
    const bool there = each.path ? *each.path < model.paths.size() : model.loop.has_value();
    return there && hysteresis_of(model, each.path) == &each && each.threshold > 0.0 &&
           each.low < each.high &&
           (each.operation == signal::HysteresisOperator::kStop ||
            each.operation == signal::HysteresisOperator::kDahl);
  });
}

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
  const bool remembers = hysteresis_of(model, {}) != nullptr;
  const auto loop = [taps, remembers](const LoopPath& each) {
    const bool inside = each.n.size() == taps && each.m.size() == taps && each.m[0] == 0.0;
    const bool of_output = each.n.empty() && each.m.empty() && !each.e.empty() && each.e[0] == 0.0;
    return each.e.size() == taps && (inside || of_output) && each.ticks >= 1 &&
           each.ticks <= kMostHeld_ticks && (remembers || each.phi.values.size() >= 2) &&
           is_table(each.phi);
  };
  // The first input is the platform's lateral acceleration, for which the gain is bounded.
  return model.inputs[0].channel == Channel::kAccelY && std::ranges::all_of(model.inputs, input) &&
         std::ranges::all_of(model.paths, path) && std::ranges::all_of(model.waves, wave) &&
         (!model.loop || loop(*model.loop)) && in_place(model);
}

bool fits(const ControlModel& model) {
  const auto small = [](const ValueMap& map) {
    return map.values.size() <= ValueTable::kMostValues;
  };
  return small(model.output) && model.inputs.size() <= ControlModelFilter::kMostInputs &&
         model.paths.size() <= ControlModelFilter::kMostPaths &&
         model.waves.size() <= ControlModelFilter::kMostWaves &&
         model.hysteresis.size() <= ControlModelFilter::kMostHysteresis &&
         std::ranges::all_of(model.inputs, [&](const auto& each) { return small(each.map); }) &&
         std::ranges::all_of(model.paths, [&](const auto& each) { return small(each.map); }) &&
         (!model.loop || small(model.loop->phi));
}

// Below 1 kHz the paper's model alone: one input, nothing inside the body or next to it.
bool suits_rate(const ControlModel& model, std::int64_t model_ticks) {
  const bool plain = model.inputs.size() == 1 && !model.loop && model.paths.empty() &&
                     model.waves.empty() && !model.adapts;
  return model.rate_hz * static_cast<double>(model_ticks) == kControlRateHz &&
         (model_ticks == 1 || plain);
}

// Samples until radius^n = 0.01, for every pole; above the limit when a pole is at or beyond 1.
std::int64_t settle_samples(const std::vector<std::complex<double>>& poles) {
  std::int64_t slowest = 1;
  for (const std::complex<double>& pole : poles) {
    const double radius = std::abs(pole);
    if (!(radius < 1.0)) return kMaxSettle_ticks + 1;
    const double samples = std::ceil(std::log(0.01) / std::log(radius));
    if (!(samples <= static_cast<double>(kMaxSettle_ticks))) return kMaxSettle_ticks + 1;
    slowest = std::max(slowest, static_cast<std::int64_t>(samples));
  }
  return slowest;
}

// Of the slowest lag next to the body.  A lag starts where its channel is, so that a longer one is
// near already and need not be waited for.
std::int64_t lag_settle_ticks(const ControlModel& model) {
  double slowest_s = 0.0;
  for (const DirectPath& path : model.paths) slowest_s = std::max(slowest_s, path.lag_s);
  const double ticks = std::ceil(-std::log(0.01) * slowest_s * kControlRateHz);
  return static_cast<std::int64_t>(std::min(ticks, static_cast<double>(kMaxSettle_ticks)));
}

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

// METHOD Eq. CC-14, by running the model's filter.  True where the model asks for no more than
// kMaxRest_n while nothing moves, once it has settled; waves are bounded by check_strength().
// settle: [ticks] of the model's slowest pole
bool rests(const ControlModel& model, std::int64_t settle) {
  ControlModel still = model;
  still.waves.clear();
  ControlModelFilter filter(still, settle);
  ControlModelFilter::Force force{};
  for (Tick tick = 0; tick < 2 * settle + 10; ++tick) force = filter.step(ChannelSample{}, tick);
  return std::abs(force.feedthrough_n) + std::abs(force.beside_n) <= kMaxRest_n;
}

// METHOD Eq. CC-14 for a spring inside the body (Eq. CC-7): stable with its least, middle and
// greatest slope, and a trial run through the motion's band stays bounded and dies away, to what a
// spring with memory may hold.  A test, no proof: the force envelope stands behind it.  Takes
// milliseconds.
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

ModelCheck checked(const ControlModel& model, const ModelBounds& bounds) {
  const auto refused = [](Refusal why) { return ModelCheck{why, 0}; };
  if (!fits(model)) return refused(Refusal::kTooMany);
  if (!finite(model)) return refused(Refusal::kNotFinite);
  if (!well_formed(model)) return refused(Refusal::kMalformed);
  if (!suits_rate(model, bounds.model_ticks)) return refused(Refusal::kWrongRate);
  if (model.denominator.size() - 1 > ControlModelFilter::kMaxOrder) return refused(Refusal::kOrder);
  const signal::DifferenceModel first = path_model(model, model.inputs[0]);
  if (!signal::is_stable(first)) return refused(Refusal::kUnstable);
  const std::vector<std::complex<double>> poles = signal::poles(first);
  for (const std::complex<double>& pole : poles) {
    if (!(std::abs(pole) < 1.0)) return refused(Refusal::kUnstable);
  }
  std::int64_t settle = settle_samples(poles) * bounds.model_ticks;
  if (settle > kMaxSettle_ticks) return refused(Refusal::kSettling);
  settle = std::max(settle, lag_settle_ticks(model));
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

// At least a hundredth of critical damping: what still has a third of its swing after 16 periods is
// no arm, and a damping ratio that underflows to 0 is no oscillator that signal::SecondOrderLag can
// step.
bool is_hand(const HandCompliance& hand) noexcept {
  constexpr double kLeastRatio = 0.01;
  const double critical = 2.0 * std::sqrt(hand.mass_kg * hand.stiffness_n_m);
  return hand.mass_kg >= 0.1 && hand.mass_kg <= 10.0 && hand.stiffness_n_m >= 50.0 &&
         hand.stiffness_n_m <= 10'000.0 && hand.damping_n_s_m >= kLeastRatio * critical &&
         hand.damping_n_s_m < critical && hand.lever_m >= 0.02 && hand.lever_m <= 0.5;
}

std::string_view describe(Refusal refusal) noexcept {
  // In the order of the enumeration.
  constexpr std::array<std::string_view, 13> kWords{
      "model taken",
      "model is empty, its sizes differ, its denominator does not start with 1, or a lag, a "
      "frequency, a table's ends or an element with memory are out of order",
      "a coefficient is not a finite number",
      "model is not at the canceller's rate (1000 Hz, or sampling.model_ticks of them), or below "
      "1000 Hz has more than a_y",
      "model order is above 12",
      "a pole lies on or outside the unit circle",
      "model takes longer than 10 s to settle",
      "model gain is above the bound",
      "more than 4 inputs, 6 paths, 6 waves, 7 elements with memory or 129 values in a table",
      "a further channel, a path next to the body, a wave or what is held at rest is stronger than "
      "its bound",
      "the spring inside the body is not stable at each of its slopes, or its motion does not die "
      "away",
      "model asks for a force while nothing moves",
      "mass, damping, stiffness or lever of the hand are out of range"};
  static_assert(kWords.size() == static_cast<std::size_t>(Refusal::kCompliance) + 1);
  const auto number = static_cast<std::size_t>(refusal);
  return number < kWords.size() ? kWords[number] : "unknown";
}

void require_taken(Refusal refusal, const std::string& what, const std::string& want) {
  if (refusal != Refusal::kNone) throw ConfigError(what, std::string(describe(refusal)), want);
}

std::int64_t settle_ticks(const signal::DifferenceModel& model) {
  return settle_samples(signal::poles(model));
}

ModelCheck check_model(const ControlModel& model, const ModelBounds& bounds) noexcept {
  try {
    return checked(model, bounds);
  } catch (const std::exception&) {
    // Memory alone can run out in there; a model must not end the process.
    return {Refusal::kMalformed, 0};
  }
}

}  // namespace stillhand::cancellation

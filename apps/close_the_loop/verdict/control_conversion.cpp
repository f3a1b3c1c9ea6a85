// SPDX-License-Identifier: Apache-2.0
#include "apps/close_the_loop/verdict/control_conversion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/close_the_loop/verdict/control_laws.hpp"
#include "apps/close_the_loop/verdict/control_response.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/model_run.hpp"

namespace stillhand::close_the_loop {
namespace {

namespace control = diagnosis::control;
using diagnosis::Effect;
using diagnosis::SeenRange;

SeenRange range_of(const std::vector<double>& values) {
  const auto [low, high] = std::ranges::minmax(values);
  return {{}, {}, low, high};
}

std::size_t whole_ticks(double rate_hz) {
  constexpr double kRounding = 1e-9;
  const double ticks = kControlRateHz / rate_hz;
  const double whole = std::round(ticks);
  const bool fits = std::abs(ticks - whole) < kRounding * ticks && whole >= 1.0 &&
                    whole <= static_cast<double>(cancellation::kMostHeld_ticks);
  return fits ? static_cast<std::size_t>(whole) : 1;
}

class Conversion {
 public:
  Conversion(const diagnosis::Model& model, const diagnosis::Signals& signals,
             const ControlOptions& options)
      : model_(model), signals_(signals), options_(options) {
    for (const Effect& effect : model_.effects) {
      if (has_role<control::Gain>(effect)) gain_ *= gain_at_the_end(effect, signals_);
    }
  }

  ConvertedModel run(const std::vector<double>& denominator);

 private:
  template <typename Law>
  static bool has_role(const Effect& effect) {
    return std::holds_alternative<Law>(diagnosis::effect_kind(effect.kind).body_role(effect));
  }
  void convert_inputs();
  void convert_output();
  // Of the effects with a map as their law, one behind the other.
  template <typename Law>
  std::function<double(double)> maps_of(const std::string& channel, bool& any) const;
  // What becomes of an effect, one function a law.
  void carry(const Effect& effect, const control::LeftOut& law) {
    treat(effect, false, law.reason);
  }
  void carry(const Effect& effect, const control::NotFelt& law) { treat(effect, true, law.reason); }
  void carry(const Effect& effect, const control::InputDelay& /*law*/) {
    treat(effect, true, "the prediction comes later by the same time");
  }
  void carry(const Effect& effect, const control::InputMap& /*law*/) {
    treat(effect, true, "the map runs before the canceller's body");
  }
  void carry(const Effect& effect, const control::OutputMap& /*law*/) {
    treat(effect, true, "the map runs behind the canceller's body");
  }
  void carry(const Effect& effect, const control::Gain& /*law*/) {
    treat(effect, true,
          "the canceller starts with the gain at the end of the recording and adapts");
  }
  void carry(const Effect& effect, const control::Mode& /*law*/) {
    treat(effect, true, "the canceller's body has two more poles");
  }
  void carry(const Effect& effect, const control::Spring& law);
  void carry(const Effect& effect, const control::Path& law);
  void carry(const Effect& effect, const control::Hysteresis& law);
  void carry(const Effect& effect, const control::Waves& law);
  void carry(const Effect& effect, const control::Friction& law);
  // Of every channel that the effect reads; where the canceller does not receive one, the effect is
  // left alone.
  std::optional<std::vector<cancellation::Channel>> received(const Effect& effect);
  void treat(const Effect& effect, bool cancelled, std::string how) {
    const std::string channel = effect.channels.empty() ? "" : effect.channels.front();
    out_.treatments.push_back({effect.kind, cancelled, std::move(how), channel});
  }
  // What the input drives comes sooner by the lead; what the spring drives is driven by it.
  std::vector<double> numerator(const Response& wanted);
  std::vector<double> of_spring(const std::vector<double>& c, bool late);
  std::vector<double> taken(NumeratorFit fit) {
    out_.conversion_error = std::max(out_.conversion_error, fit.error);
    return std::move(fit.numerator);
  }
  void add_lagged(const Effect& effect, cancellation::Channel channel, double lag_s);
  // A polynomial over the body's own poles.
  [[nodiscard]] Response over_poles(std::vector<double> c) const;
  [[nodiscard]] double turn(double frequency_hz) const {
    return kTwoPi * frequency_hz / model_.rate_hz;
  }
  // What is read of an effect's i-th channel, or of a map's argument.
  [[nodiscard]] static SeenRange seen(const Effect& effect, std::size_t i,
                                      const std::vector<double>& values) {
    return i < effect.seen.size() ? effect.seen[i] : range_of(values);
  }
  // Held at the range's edges, Eq. DG-56; everywhere while no range is known.
  [[nodiscard]] static cancellation::ValueMap held_channel(const Effect& effect, std::size_t i) {
    if (i >= effect.seen.size() || !(effect.seen[i].low < effect.seen[i].high)) return {};
    return held(effect.seen[i].lower_edge(), effect.seen[i].upper_edge());
  }

  const diagnosis::Model& model_;
  const diagnosis::Signals& signals_;
  const ControlOptions& options_;
  /// Of a sample of the model, where it is a whole number of ticks; otherwise 1.
  const std::size_t held_ticks_ = whole_ticks(model_.rate_hz);
  const double delay_s_ = input_delay_s(model_);
  double gain_ = 1.0;  ///< of the body alone: modes and paths lie next to it
  ConvertedModel out_;
};

std::vector<double> Conversion::numerator(const Response& wanted) {
  const auto sooner = [&](double f) {
    return wanted(f) * std::polar(1.0, kTwoPi * f * options_.lead_s);
  };
  return taken(fit_numerator(out_.model.denominator, sooner, false, options_));
}

std::vector<double> Conversion::of_spring(const std::vector<double>& c, bool late) {
  if (held_ticks_ > 1) {
    return taken(
        held_numerator(out_.model.denominator, c, model_.body.denominator, held_ticks_, late));
  }
  return taken(fit_numerator(out_.model.denominator, over_poles(c), late, options_));
}

Response Conversion::over_poles(std::vector<double> c) const {
  return [this, c = std::move(c)](double f) {
    return polynomial_at(c, turn(f)) / polynomial_at(model_.body.denominator, turn(f));
  };
}

template <typename Law>
std::function<double(double)> Conversion::maps_of(const std::string& channel, bool& any) const {
  std::vector<const Effect*> maps;
  for (const Effect& effect : model_.effects) {
    if (!has_role<Law>(effect)) continue;
    if (channel.empty() || effect.channels.at(0) == channel) maps.push_back(&effect);
  }
  any = !maps.empty();
  return [maps = std::move(maps)](double value) {
    for (const Effect* effect : maps) {
      value = diagnosis::mapped_in_part(diagnosis::effect_kind(effect->kind), *effect, value);
    }
    return value;
  };
}

void Conversion::convert_inputs() {
  std::vector<cancellation::InputPath> of_modes;
  for (std::size_t k = 0; k < model_.inputs.size(); ++k) {
    const auto channel = channel_of(model_.inputs[k]);
    if (!channel) {
      throw ConfigError("the model's input", model_.inputs[k],
                        "a channel that the canceller receives");
    }
    const auto body = [&](double f) {
      return gain_ * body_response(model_, k, f) * std::polar(1.0, -kTwoPi * f * delay_s_);
    };
    const auto modes = [&](double f) { return mode_response(model_, k, f); };
    bool mapped = false;
    const auto map = maps_of<control::InputMap>(model_.inputs[k], mapped);
    if (!mapped) {
      const auto both = [&](double f) { return body(f) + modes(f); };
      out_.model.inputs.push_back({*channel, {}, numerator(both)});
      continue;
    }
    const SeenRange range = range_of(signals_.inputs()[k].values);
    out_.model.inputs.push_back(
        {*channel, nearest_table(range.lower_edge(), range.upper_edge(), map), numerator(body)});
    // The map acts before the body, the modes answer the input itself.
    if (has_modes(model_)) of_modes.push_back({*channel, {}, numerator(modes)});
  }
  std::ranges::move(of_modes, std::back_inserter(out_.model.inputs));
}

// The offset is no feedthrough, and the canceller asks for no force at rest; but a map bends where
// the force and the offset together are.
void Conversion::convert_output() {
  bool mapped = false;
  const auto map = maps_of<control::OutputMap>({}, mapped);
  if (!mapped) return;
  diagnosis::Model before = model_;
  std::erase_if(before.effects,
                [](const Effect& effect) { return has_role<control::OutputMap>(effect); });
  std::vector<double> force = diagnosis::free_run(before, signals_).prediction;
  const double offset = model_.body.offset;
  for (double& value : force) value -= offset;
  const SeenRange range = range_of(force);
  const double at_rest = map(offset);
  out_.model.output = nearest_table(range.lower_edge(), range.upper_edge(),
                                    [&](double y) { return map(offset + y) - at_rest; });
}

std::optional<std::vector<cancellation::Channel>> Conversion::received(const Effect& effect) {
  std::vector<cancellation::Channel> channels;
  for (const std::string& name : effect.channels) {
    const auto channel = channel_of(name);
    if (!channel) {
      treat(effect, false, "the canceller does not receive " + name);
      return std::nullopt;
    }
    channels.push_back(*channel);
  }
  return channels;
}

void Conversion::carry(const Effect& effect, const control::Spring& law) {
  const diagnosis::LoopPath path = diagnosis::loop_path(effect, model_.body.order());
  const bool of_force = path.of_output() && model_.inputs.size() > 1;
  diagnosis::ModelRun run;
  diagnosis::run_all(model_, signals_, run);
  const SeenRange range = seen(effect, 0, run.free.argument);
  const diagnosis::Nonlinearity shape = diagnosis::effect_kind(effect.kind).feedback(effect);
  cancellation::LoopPath loop;
  loop.ticks = static_cast<Tick>(held_ticks_);
  loop.e = of_spring(path.e, path.of_output());
  for (double& e : loop.e) e *= gain_;
  if (!of_force) {
    // Around the body's force without its gain and what lies next to it: z has its numerator.
    const std::vector<double>& n = path.of_output() ? model_.body.numerators.front() : path.n;
    const Response z = over_poles(n);
    const auto later = [&](double f) { return z(f) * std::polar(1.0, -kTwoPi * f * delay_s_); };
    loop.n = numerator(later);
    loop.m = of_spring(path.of_output() ? path.e : path.m, true);
  }
  // Where z is the force itself, it is the one behind the gain.
  const double z_gain = of_force ? gain_ : 1.0;
  const double low = std::min(z_gain * range.lower_edge(), z_gain * range.upper_edge());
  const double high = std::max(z_gain * range.lower_edge(), z_gain * range.upper_edge());
  if (law.memory) {
    out_.model.hysteresis.push_back(
        {std::nullopt, *law.memory, std::abs(z_gain) * shape.threshold, low, high});
    // The operators are odd.
    if (z_gain < 0.0) {
      for (double& e : loop.e) e = -e;
    }
  } else {
    loop.phi = held_table(low, high, [&](double z) {
      diagnosis::LoopMemory none;
      return shape.phi(z / (z_gain * shape.threshold), none);
    });
  }
  out_.model.loop = std::move(loop);
  treat(effect, true,
        law.memory ? "the spring runs inside the canceller's body, with its memory"
                   : "the spring runs inside the canceller's body");
}

// y(n) = k y(n-1) + (1 - k) x(n) at the model's rate has a zero and its pole at the control rate,
// of which the pole's part is a lag and the rest a path without one.
void Conversion::add_lagged(const Effect& effect, cancellation::Channel channel, double lag_s) {
  const double keep = std::exp(-1.0 / (lag_s * model_.rate_hz));
  const double keep_fast = std::exp(-kControlPeriod_s / lag_s);
  const auto wanted = [&](double f) {
    return (1.0 - keep) / (1.0 - keep * std::polar(1.0, -turn(f))) *
           std::polar(1.0, kTwoPi * f * options_.lead_s);
  };
  const NumeratorFit fit = fit_numerator({1.0, -keep_fast}, wanted, false, options_);
  out_.conversion_error = std::max(out_.conversion_error, fit.error);
  const double direct = -fit.numerator[1] / keep_fast;
  const double lagged = (fit.numerator[0] - direct) / (1.0 - keep_fast);
  const cancellation::ValueMap map = held_channel(effect, 0);
  const double c = factors_of(effect).at(0);
  out_.model.paths.push_back({channel, lag_s, map, lagged * c});
  out_.model.paths.push_back({channel, 0.0, map, direct * c});
}

void Conversion::carry(const Effect& effect, const control::Path& law) {
  const auto channels = received(effect);
  if (!channels) return;
  if (law.through_body) {
    const Response wanted = over_poles(diagnosis::difference_basis(factors_of(effect)));
    out_.model.inputs.push_back({channels->front(), held_channel(effect, 0), numerator(wanted)});
  } else if (law.lag_s > 0.0) {
    add_lagged(effect, channels->front(), law.lag_s);
  } else {
    for (std::size_t i = 0; i < channels->size(); ++i) {
      out_.model.paths.push_back(
          {channels->at(i), 0.0, held_channel(effect, i), factors_of(effect).at(i)});
    }
  }
  std::string names = effect.channels.front();
  for (std::size_t i = 1; i < effect.channels.size(); ++i) names += " and " + effect.channels[i];
  treat(effect, true, "a path from " + names + " next to the body");
}

void Conversion::carry(const Effect& effect, const control::Hysteresis& law) {
  const auto channels = received(effect);
  if (!channels) return;
  const SeenRange range = seen(effect, 0, signals_.at(effect.channels.front()).values);
  out_.model.hysteresis.push_back({out_.model.paths.size(), law.operation, law.threshold,
                                   range.lower_edge(), range.upper_edge()});
  const std::vector<double> factors = factors_of(effect);
  out_.model.paths.push_back({channels->front(), 0.0, {}, factors.at(0)});
  if (factors.size() > 1) {
    out_.model.paths.push_back({channels->front(), 0.0, held_channel(effect, 0), factors[1]});
  }
  treat(effect, true, "a path with memory from " + effect.channels.front() + " next to the body");
}

void Conversion::carry(const Effect& effect, const control::Waves& law) {
  const auto channels = received(effect);
  if (!channels) return;
  const auto channel = channels->empty() ? std::nullopt : std::optional(channels->front());
  add_waves(effect, channel, law.frequency, 1.0, out_.model);
  treat(effect, true,
        channel ? "the motor opposes the ripple at each value of " + effect.channels.front()
                : "the sample clock carries the tone's phase on");
}

void Conversion::carry(const Effect& effect, const control::Friction& law) {
  const auto channels = received(effect);
  if (!channels) return;
  out_.model.paths.push_back(
      friction_path(channels->front(), law.transition, factors_of(effect).at(0)));
  treat(effect, true, "the motor opposes the sign of " + effect.channels.front());
}

ConvertedModel Conversion::run(const std::vector<double>& denominator) {
  out_.model.rate_hz = kControlRateHz;
  out_.model.denominator = denominator;
  convert_inputs();
  convert_output();
  for (const Effect& effect : model_.effects) {
    std::visit([&](const auto& law) { carry(effect, law); },
               diagnosis::effect_kind(effect.kind).body_role(effect));
  }
  return std::move(out_);
}

}  // namespace

double gain_at_the_end(const Effect& effect, const diagnosis::Signals& signals) {
  std::vector<double> gain(signals.size(), 1.0);
  diagnosis::gain_in_part(effect, signals, gain);
  const std::size_t from = gain.size() - gain.size() / 10 - 1;
  double sum = 0.0;
  for (std::size_t n = from; n < gain.size(); ++n) sum += gain[n];
  return sum / static_cast<double>(gain.size() - from);
}

ConvertedModel converted(const diagnosis::Model& model, const diagnosis::Signals& signals,
                         const std::vector<double>& denominator, const ControlOptions& options) {
  return Conversion(model, signals, options).run(denominator);
}

}  // namespace stillhand::close_the_loop

// SPDX-License-Identifier: Apache-2.0
// Every kind and form of effect, with numbers that are drawn: what is diagnosed, what its file
// predicts, what the exported model does at 1 kHz and what the canceller predicts live are one
// force, within the bound of Eq. CL-7, or the effect is left alone with a reason.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string_view>

#include "apps/close_the_loop/verdict/control_check.hpp"
#include "apps/close_the_loop/verdict/control_model.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/interpolation.hpp"
#include "services/core/diagnosis/model/seen_range.hpp"
#include "services/files/cancellation/control_model_file.hpp"
#include "services/files/diagnosis/model_file.hpp"
#include "tests/support/rms_share.hpp"
#include "tests/unit/diagnosis/every_effect.hpp"

namespace stillhand::close_the_loop::every_kind_on_the_motor_test {
namespace {

using cancellation::ControlModel;
using diagnosis::Effect;
using diagnosis::Model;
using diagnosis::Signals;
namespace made = diagnosis::made;

constexpr std::size_t kCount = 6000;  // 60 s at 100 Hz
constexpr double kBound = 0.01;       // Eq. CL-7
constexpr std::uint64_t kSeed = 31;
constexpr double kStick = 0.1;  // [rad] RMS: a stick's travel, where the list has 1 rad

// As every_effect.hpp names them, but for the input, which the canceller receives as a_y: in the
// motion's band, to which responses are met with full weight (Eq. CL-2).
diagnosis::Measurement measurement_of(std::uint64_t seed) {
  auto channels = made::every_channel(kCount, seed);
  for (diagnosis::Channel& channel : channels.channels) {
    if (channel.name == "u") {
      channel.name = "a_y";
      channel.values = made::ride(kCount, seed, ControlOptions{}.low_hz, ControlOptions{}.high_hz);
    }
    if (channel.name == "theta") channel.values = made::scaled_to(channel.values, kStick);
  }
  return channels;
}

Signals signals_of(std::uint64_t seed) { return {measurement_of(seed), {"a_y"}, "y"}; }

Model model_of(std::vector<Effect> effects) {
  Model model = made::model_of(made::two_pole_body(), std::move(effects));
  model.inputs = {"a_y"};
  return model;
}

// Moves fitted numbers by up to a fifth, and those over the stick's angle or over the force, which
// the list has for 1 rad and 1 N, to theirs.
Effect drawn(Effect effect, double force_n, signal::Gaussian& draw) {
  const auto moved = [&](double value) { return value * (0.8 + 0.4 * draw.uniform()); };
  for (std::string& channel : effect.channels) {
    if (channel == "u") channel = "a_y";
  }
  for (diagnosis::Parameter& parameter : effect.parameters) {
    double scale = 1.0;
    if (parameter.unit == "rad") scale = kStick;
    if (parameter.unit == "1/rad") scale = 1.0 / kStick;
    if (parameter.unit == "N") scale = force_n;
    if (parameter.unit == "1/N^2") scale = std::pow(force_n, -2.0);
    // Knots stay in their order.
    const double factor = parameter.fitted ? moved(scale) : scale;
    for (double* each : {&parameter.value, &parameter.lower, &parameter.upper}) *each *= factor;
  }
  for (double& coefficient : effect.coefficients) coefficient = moved(coefficient);
  return effect;
}

double difference(const std::vector<double>& got, const std::vector<double>& want,
                  std::size_t from) {
  support::RmsShare missed;
  for (std::size_t n = from; n < want.size(); ++n) missed.add(got[n] - want[n], want[n]);
  return missed.value();
}

// What the canceller predicts of a motion, tick by tick, at the signals' instants; each 10 ticks.
std::vector<double> live(const ControlModel& model, const Signals& signals) {
  cancellation::Countermeasure canceller({}, {.force = true});
  EXPECT_EQ(canceller.load_model(model), cancellation::Refusal::kNone);
  std::vector<double> out;
  for (std::size_t n = 0; n < signals.size(); ++n) {
    for (Tick part = n == 0 ? 0 : -9; part <= 0; ++part) {
      const Tick tick = static_cast<Tick>(10 * n) + part;
      cancellation::ChannelSample sample{};
      for (std::size_t c = 0; c < cancellation::kChannels; ++c) {
        for (const diagnosis::Signal& signal : signals.all()) {
          if (signal.name != cancellation::kChannelFacts[c].name) continue;
          sample[c] = diagnosis::value_at(signal.values, static_cast<double>(tick) / 10.0);
        }
      }
      const auto answer = canceller.step({tick, sample, kGood, true, true, {}});
      if (part == 0) out.push_back(answer.predicted_force_n);
    }
  }
  return out;
}

std::vector<double> less(std::vector<double> x, const std::vector<double>& y) {
  for (std::size_t n = 0; n < x.size(); ++n) x[n] -= y[n];
  return x;
}

// The law that an effect has in the canceller, and one that the comparison is about.
diagnosis::ControlRole role_of(const Effect& effect) {
  return diagnosis::effect_kind(effect.kind).body_role(effect);
}
template <typename Law>
bool has_law(const Effect& effect) {
  return std::holds_alternative<Law>(role_of(effect));
}

// The force that a model's effects add at 1 kHz, against what they add as diagnosed: another way
// than that of the check itself.
double added_difference(const Model& model, const Signals& signals) {
  Model plain = model;
  plain.effects.clear();
  const auto got = forces_of(
      {to_control_model(model, signals).model, to_control_model(plain, signals).model}, signals);
  const auto wanted = less(diagnosis::free_run(model, signals).prediction,
                           diagnosis::free_run(plain, signals).prediction);
  return difference(less(got[0], got[1]), wanted, kCount / 4);
}

void print(const Effect& effect, const Treatment& treatment) {
  std::printf("%-20s %-32s %-11s", effect.kind.c_str(), effect.form.c_str(),
              treatment.cancelled ? "cancelled" : "left alone");
  if (treatment.difference) {
    std::printf(" %6.3f %% %6.3f %%", 100.0 * treatment.difference->source,
                100.0 * treatment.difference->second);
  }
  std::printf("  %s\n", treatment.how.c_str());
}

// What becomes of effects on their way.
void follow(const std::vector<Effect>& effects, const Signals& signals) {
  SCOPED_TRACE(effects.front().kind + ", " + effects.front().form);
  Model model = model_of(effects);
  diagnosis::note_seen(model, signals);
  // The file.
  const Model saved = diagnosis::parse_model(diagnosis::model_json(model), "m.json");
  EXPECT_EQ(diagnosis::free_run(saved, signals).prediction,
            diagnosis::free_run(model, signals).prediction);
  // The canceller's model.
  const ConvertedModel control = to_control_model(saved, signals);
  ASSERT_EQ(control.treatments.size(), effects.size());
  bool comparable = true;
  for (std::size_t e = 0; e < effects.size(); ++e) {
    const Treatment& sut = control.treatments[e];
    print(effects[e], sut);
    EXPECT_FALSE(sut.how.empty());
    EXPECT_NE(sut.cancelled, has_law<diagnosis::control::LeftOut>(effects[e])) << sut.how;
    if (sut.difference) {
      EXPECT_LE(sut.difference->worst(), kBound);
    }
    // A gain is compared as it is at the end, and what the hand does not feel is not there at all.
    comparable = comparable && sut.cancelled && !has_law<diagnosis::control::Gain>(effects[e]) &&
                 !has_law<diagnosis::control::NotFelt>(effects[e]);
  }
  // About the mean the difference is no larger; the band is wider than that of Eq. CL-7.
  if (comparable) {
    EXPECT_LE(added_difference(saved, signals), 1.5 * kBound);
  }
  // Its own file, and the canceller live: one force.
  const ControlModel back = cancellation::parse_control_model(
      cancellation::control_model_json(control.model, 1), "c.json", 1);
  const auto exported = forces_of({control.model}, signals).front();
  EXPECT_EQ(forces_of({back}, signals).front(), exported);
  // From the tick at which the model has settled and is faded in: the same numbers, added once more
  // to 0 times those of no model.
  constexpr std::size_t kSettled = kCount / 2;
  EXPECT_LT(difference(live(back, signals), exported, kSettled), 1e-6);
}

std::vector<Effect> drawn_list() {
  const Signals signals = signals_of(kSeed);
  const double force_n = made::rms_of(diagnosis::free_run(model_of({}), signals).prediction);
  signal::Gaussian draw(5, 0);
  std::vector<Effect> all;
  // Every second one acts in part.
  for (const Effect& effect : made::every_effect()) {
    all.push_back(drawn(effect, force_n, draw));
    if (all.size() % 2 == 0) all.back().share = 0.6;
  }
  return all;
}

TEST(EveryKindOnTheMotorTest, EachIsTheDiagnosedForceOrLeftAlone) {
  const Signals signals = signals_of(kSeed);
  for (const Effect& effect : drawn_list()) follow({effect}, signals);
}

// One that changes how the body is driven, one inside it, one behind or next to it.
TEST(EveryKindOnTheMotorTest, SoAreSeveralTogether) {
  const Signals signals = signals_of(kSeed);
  const std::vector<Effect> all = drawn_list();
  const auto one = [&](std::string_view kind, std::string_view form) {
    return *std::ranges::find_if(
        all, [&](const Effect& each) { return each.kind == kind && each.form == form; });
  };
  const Effect delay = one("delay", "of the input");
  const Effect limit = one("input_saturation", "soft");
  const Effect plastic = one("hysteresis", "elastic-plastic of the output");
  const Effect dahl = one("hysteresis", "smooth inside the body");
  const Effect mode = one("resonance", "beside the body");
  const Effect path = one("coupled_input", "through the body");
  const Effect yields = one("hysteresis", "elastic-plastic, beside the body");
  const Effect step = one("regime_change", "step of the gain");
  follow({delay, dahl}, signals);
  follow({limit, dahl, yields}, signals);
  follow({step, plastic, path}, signals);
  follow({limit, mode}, signals);
  follow({mode, one("dead_zone", "play of the output")}, signals);
}

}  // namespace
}  // namespace stillhand::close_the_loop::every_kind_on_the_motor_test

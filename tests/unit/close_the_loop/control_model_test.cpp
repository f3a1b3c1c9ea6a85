// SPDX-License-Identifier: Apache-2.0
// A diagnosed model at the canceller's rate, Eq. CL-1 to CL-4: the same force from the same motion.
#include "apps/close_the_loop/verdict/control_model.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "services/core/cancellation/control_model_filter.hpp"
#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/population/population.hpp"
#include "tests/support/feedthrough_records.hpp"
#include "tests/support/rms_share.hpp"

namespace stillhand::close_the_loop::control_model_test {
namespace {

using diagnosis::Effect;

constexpr std::size_t kSlow = 10;  // control ticks a sample of the diagnosed model

// Motion at 1 kHz, and every tenth of it as a measurement.
struct Motion {
  std::vector<double> a_y = support::band_noise(60'000, 1000.0, 0.7, 2.0, 1.6, 3);
  std::vector<double> a_x = support::band_noise(60'000, 1000.0, 0.7, 2.0, 1.0, 4);

  // @param force  at 100 Hz; empty: one that has nothing to do with the motion
  [[nodiscard]] diagnosis::Signals signals(const std::vector<double>& force = {}) const {
    diagnosis::Measurement out;
    out.rate_hz = 100.0;
    out.channels = {{"a_y", "m/s^2", {}}, {"a_x", "m/s^2", {}}, {"f", "N", {}}};
    for (std::size_t n = 0; n < a_y.size(); n += kSlow) {
      out.channels[0].values.push_back(a_y[n]);
      out.channels[1].values.push_back(a_x[n]);
      out.channels[2].values.push_back(5.0 * std::sin(1e-3 * static_cast<double>(n)));
    }
    if (!force.empty()) out.channels[2].values = force;
    const std::size_t samples = out.channels[0].values.size();
    out.weight.assign(samples, 1.0);
    out.stretches = {{0, samples, 0.0}};
    return {out, {"a_y"}, "f"};
  }
};

// Poles of two modes, 2.6 Hz and 8 Hz, at 100 Hz.
diagnosis::Model two_modes() {
  const auto mode = [](double hz, double damping) {
    const double radius = std::exp(-kTwoPi * hz * damping / 100.0);
    return std::array{
        -2.0 * radius * std::cos(kTwoPi * hz * std::sqrt(1.0 - damping * damping) / 100.0),
        radius * radius};
  };
  const auto low = mode(2.6, 0.25);
  const auto high = mode(8.0, 0.2);
  diagnosis::Model model;
  model.rate_hz = 100.0;
  model.inputs = {"a_y"};
  model.output = "f";
  model.output_unit = "N";
  model.body.denominator = {1.0, low[0] + high[0], low[1] + high[1] + low[0] * high[0],
                            low[0] * high[1] + low[1] * high[0], low[1] * high[1]};
  model.body.numerators = {{-0.02, -0.01, 0.01, 0.015, -0.02}};
  return model;
}

// RMS difference of the filter at 1 kHz from the model at 100 Hz, over the model's RMS.
double difference(const diagnosis::Model& model, const cancellation::ControlModel& control,
                  const Motion& motion, double late_s = 0.0) {
  const std::vector<double> expected = diagnosis::free_run(model, motion.signals()).prediction;
  cancellation::ControlModelFilter filter(control, 1);
  const auto shift = static_cast<std::size_t>(std::lround(late_s * 1000.0));
  std::vector<double> got;
  for (std::size_t n = 0; n < motion.a_y.size(); ++n) {
    cancellation::ChannelSample sample{};
    sample[static_cast<std::size_t>(cancellation::Channel::kAccelX)] = motion.a_x[n];
    sample[static_cast<std::size_t>(cancellation::Channel::kAccelY)] = motion.a_y[n];
    const auto force = filter.step(sample, static_cast<Tick>(n));
    got.push_back(force.feedthrough_n + force.beside_n);
  }
  support::RmsShare missed;
  for (std::size_t n = 500; n + 10 < expected.size(); ++n) {
    missed.add(got[n * kSlow - shift] - expected[n], expected[n]);
  }
  return missed.value();
}

TEST(ControlModelTest, ALinearBodyGivesTheSameForce) {
  const Motion motion;
  const diagnosis::Model model = two_modes();
  const ConvertedModel control = to_control_model(model, motion.signals());
  EXPECT_LT(difference(model, control.model, motion), 0.005);
  EXPECT_LT(control.conversion_error, 0.005);
  EXPECT_EQ(cancellation::check_model(control.model, {60.0, 25.0}).refusal,
            cancellation::Refusal::kNone);
}

// A pole of 0.9995 at 100 Hz settles to 1 % in 92 s; the canceller takes 10 s.
TEST(ControlModelTest, ASlowPoleThatAZeroCancelsIsLeftOut) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  const diagnosis::Model quick = model;
  model.body.denominator = diagnosis::product(model.body.denominator, {1.0, -0.9995});
  model.body.numerators.front() = diagnosis::product(model.body.numerators.front(), {1.0, -0.9995});
  const ConvertedModel control = to_control_model(model, motion.signals());
  EXPECT_EQ(cancellation::check_model(control.model, {60.0, 25.0}).refusal,
            cancellation::Refusal::kNone);
  EXPECT_LT(difference(quick, control.model, motion), 0.005);
}

TEST(ControlModelTest, WithALeadItComesSooner) {
  const Motion motion;
  const diagnosis::Model model = two_modes();
  const ControlOptions options{.lead_s = 0.02};
  const ConvertedModel control = to_control_model(model, motion.signals(), options);
  EXPECT_LT(difference(model, control.model, motion, 0.02), 0.03);
  EXPECT_GT(difference(model, control.model, motion), 0.1);
}

// z: the response of two_modes() in units of its threshold; phi takes some of the force off again.
Effect play_inside() {
  constexpr std::size_t kOrder = 4;
  Effect spring{
      "dead_zone", "play inside the body", {}, {}, std::vector<double>(3 * kOrder + 2, 0.0)};
  const std::vector<double> n = diagnosis::difference_basis({-0.02, -0.01, 0.01, 0.015, -0.02});
  const std::vector<double> e = diagnosis::difference_basis({0.0, -0.05, 0.02, 0.01, 0.0});
  for (std::size_t i = 0; i <= kOrder; ++i) {
    spring.coefficients[i] = e[i];
    spring.coefficients[kOrder + 1 + i] = n[i];
  }
  spring.coefficients[2 * kOrder + 2] = -0.002;
  return spring;
}

TEST(ControlModelTest, ASpringInsideTheBodyGivesTheSameForce) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  const diagnosis::Model linear = model;
  model.effects.push_back(play_inside());
  const ConvertedModel control = to_control_model(model, motion.signals());
  ASSERT_TRUE(control.model.loop) << control.treatments.front().how;
  EXPECT_LT(difference(model, control.model, motion), 0.02);
  EXPECT_GT(difference(linear, control.model, motion), 0.05);
}

TEST(ControlModelTest, EffectsBesideTheBodyGiveTheSameForce) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.effects.push_back(
      {"coupled_input", "lagged", {"a_x"}, {{"lag", "s", 0.05, 0.0, 1.0}}, {1.2}});
  model.effects.push_back(
      {"tone", "beside the body", {}, {{"frequency", "Hz", 9.3, 9.0, 9.6}}, {0.4, 0.7}});
  const ConvertedModel control = to_control_model(model, motion.signals());
  // The lag of 50 ms at 100 Hz is half a sample later than at 1 kHz.
  EXPECT_LT(difference(model, control.model, motion), 0.02);
  EXPECT_EQ(control.treatments.size(), 2u);
  EXPECT_TRUE(control.treatments[0].cancelled);
}

TEST(ControlModelTest, AGainIsThatOfTheBodyAtTheRecordsEndAndNotOfTheModesBesideIt) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.effects.push_back(
      {"time_varying_gain", "linear", {}, {{"change", "-", -0.5, -3.0, 3.0}}, {}});
  model.effects.push_back(
      {"resonance",
       "beside the body",
       {"a_y"},
       {{"frequency", "Hz", 3.2, 0.5, 45.0}, {"damping_ratio", "-", 0.3, 0.0, 1.0}},
       {-0.06, 0.05}});
  const ConvertedModel control = to_control_model(model, motion.signals());
  // What the gain is on average over the last tenth of the record.
  diagnosis::Model at_the_end = model;
  at_the_end.effects.erase(at_the_end.effects.begin());
  for (double& b : at_the_end.body.numerators.front()) b *= 1.0 - 0.5 * 0.9;
  EXPECT_LT(difference(at_the_end, control.model, motion), 0.01);
  for (double& c : at_the_end.effects.front().coefficients) c *= 1.0 - 0.5 * 0.9;
  EXPECT_GT(difference(at_the_end, control.model, motion), 0.05);
}

TEST(ControlModelTest, WhatCantBeCancelledIsSaid) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.effects.push_back(
      {"asymmetry", "square, beside the body", {"a_x"}, {{"centre", "m/s^2", 0.0}}, {0.5}});
  const ConvertedModel control = to_control_model(
      model, motion.signals(diagnosis::free_run(two_modes(), motion.signals()).prediction));
  ASSERT_EQ(control.treatments.size(), 1u);
  EXPECT_FALSE(control.treatments[0].cancelled);
  EXPECT_LT(difference(two_modes(), control.model, motion), 0.005);
}

TEST(ControlModelTest, ALimitOfTheForceSensorIsPredictedAway) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.effects.push_back({"output_saturation", "hard", {}, {{"limit", "N", 0.1, 0.0, 9.0}}, {}});
  const ConvertedModel control = to_control_model(model, motion.signals());
  ASSERT_EQ(control.treatments.size(), 1u);
  EXPECT_TRUE(control.treatments[0].cancelled);
  EXPECT_TRUE(control.model.output.values.empty());
  EXPECT_LT(difference(two_modes(), control.model, motion), 0.005);
}

TEST(ControlModelTest, APathThroughTheBodyBecomesAnInputOfItsOwn) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.effects.push_back({"coupled_input",
                           "through the body",
                           {"a_x"},
                           {},
                           diagnosis::difference_basis({0.01, 0.005, -0.01, 0.0, 0.01})});
  const ConvertedModel control = to_control_model(model, motion.signals());
  EXPECT_EQ(control.model.inputs.size(), 2u);
  EXPECT_LT(difference(model, control.model, motion), 0.01);
  EXPECT_GT(difference(two_modes(), control.model, motion), 0.05);
}

// The body that was fitted with a spring is not that of the hand without it: alone, two_modes() is
// a worse model of this force than the body that is fitted again.
TEST(ControlModelTest, ASpringThatCantBeCarriedLeavesABodyFittedWithoutIt) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.effects = {play_inside()};
  const diagnosis::Signals signals =
      motion.signals(diagnosis::free_run(model, motion.signals()).prediction);
  EXPECT_TRUE(to_control_model(model, signals).treatments.front().cancelled);
  const ControlOptions strict{.max_difference = 1e-9};
  const ConvertedModel control = to_control_model(model, signals, strict);
  EXPECT_FALSE(control.treatments.front().cancelled);
  EXPECT_FALSE(control.model.loop);
  const cancellation::ControlModel as_it_was = to_control_model(two_modes(), signals).model;
  EXPECT_LT(difference(model, control.model, motion), 0.8 * difference(model, as_it_was, motion));
}

TEST(ControlModelTest, AModelOfAnotherChannelIsRefused) {
  const Motion motion;
  diagnosis::Model model = two_modes();
  model.inputs = {"temperature"};
  EXPECT_THROW(to_control_model(model, motion.signals()), ConfigError);
}

TEST(AverageHandTest, IsThatOfThePopulationsMeanSubject) {
  const cancellation::HandCompliance sut = average_hand();
  const auto mean = population::mean_subject({}).who.arm;
  EXPECT_EQ(sut.stiffness_n_m, mean.effective_stiffness_n_m);
  EXPECT_EQ(sut.mass_kg, mean.effective_mass_kg);
  EXPECT_EQ(sut.damping_n_s_m, mean.effective_damping_n_s_m);
}

}  // namespace
}  // namespace stillhand::close_the_loop::control_model_test

// SPDX-License-Identifier: Apache-2.0
// Parts together: Eq. MI-6.  The force is bounded and fails to zero; a known plant is cancelled.
#include "services/core/cancellation/parts/countermeasure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "apps/libraries/session/core/conditions.hpp"
#include "services/core/admittance/arm_fit.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/rms_share.hpp"

namespace stillhand::cancellation::countermeasure_test {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kLever_m = 0.10;

// Feedthrough to force of about -3 N per m/s^2 with a mode at 3 Hz.
signal::DifferenceModel model() {
  const double r = std::exp(-0.3 * kTurn * 3.0 * 1e-3);
  const double c = 2.0 * r * std::cos(kTurn * 3.0 * 1e-3);
  const double gain = -3.0 * (1.0 - c + r * r);
  return {1000.0, {gain, 0.0, 0.0}, {1.0, -c, r * r}};
}

// Of each kind that is made of its values, the first part in the table of conditions.
std::vector<Part> made_parts() {
  std::vector<Part> out;
  for (const PartRow& kind : kPartRows) {
    if (kind.make == nullptr) continue;
    const std::size_t before = out.size();
    for (const session::ConditionRow& condition : session::condition_table()) {
      const auto part = std::ranges::find(condition.parts, kind.kind, &Part::kind);
      if (part == condition.parts.end()) continue;
      out.push_back(*part);
      break;
    }
    EXPECT_GT(out.size(), before) << "no condition has part " << static_cast<int>(kind.kind);
  }
  return out;
}

// All that stand next to each other: a trial has one filter on the command.
Recipe everything() {
  Recipe out;
  out.force = true;
  out.model = control_model(model());
  out.schedule =
      ScheduleConfig{.relaxed = admittance::mean_arm(), .holding = admittance::mean_arm()};
  out.signal = SignalConfig{
      .feedthrough_to_position = model(), .moved_by_motor = admittance::mean_arm(), .stick = {}};
  bool filtered = false;
  for (const Part& part : made_parts()) {
    const PartRow& row = *row_of(part.kind);
    if (row.in_place_of || (row.filters_command && filtered)) continue;
    filtered = filtered || row.filters_command;
    out.parts.push_back(part);
    // All three terms: no condition has a mass.
    if (part.kind == PartKind::kImpedance) out.parts.back().values = {300.0, 20.0, 0.2};
  }
  return out;
}

CountermeasureInput input(Tick tick, double accel_m_s2, double theta_rad, double omega_rad_s) {
  CountermeasureInput out{};
  out.tick = tick;
  out.sensed[static_cast<std::size_t>(Channel::kAccelY)] = accel_m_s2;
  out.sensed[static_cast<std::size_t>(Channel::kTheta)] = theta_rad;
  out.sensed[static_cast<std::size_t>(Channel::kOmega)] = omega_rad_s;
  out.enabled = out.permitted = true;
  out.trial = {1, TrialPhase::kTracking, 0, 1'000'000, 0};
  return out;
}

Recipe only(const Part& part) { return {.parts = {part}}; }
const Part kDamper{PartKind::kImpedance, {0.0, 30.0, 0.0}};

// Each that drives the motor alone, and all together.
std::vector<Recipe> recipes() {
  const Recipe all = everything();
  std::vector<Recipe> out{all};
  Recipe one;
  one.force = true;
  one.model = all.model;
  out.push_back(one);
  one = {};
  one.schedule = all.schedule;
  out.push_back(one);
  for (const Part& part : all.parts) {
    if (row_of(part.kind)->drives_motor) out.push_back(only(part));
  }
  one = {};
  one.perturbation = signal::Multisine(1000, 1000.0, {{3, 30.0, 0.7}});  // above the limit
  out.push_back(one);
  return out;
}

TEST(CountermeasureTest, TheForceStaysWithinItsEnvelopeForAnyInput) {
  std::mt19937_64 engine(1);
  const auto draw = [&](double scale) {
    const int kind = std::uniform_int_distribution(0, 40)(engine);
    if (kind == 0) return std::numeric_limits<double>::quiet_NaN();
    if (kind == 1) return 1e308;
    if (kind == 2) return -std::numeric_limits<double>::infinity();
    return std::normal_distribution(0.0, scale)(engine);
  };
  const signal::ForceLimits limits;
  for (const Recipe& recipe : recipes()) {
    Countermeasure sut({}, recipe);
    double last_n = 0.0;
    Tick tick = 0;
    for (int n = 0; n < 100'000; ++n) {
      tick += std::uniform_int_distribution(0, 20)(engine) == 0 ? 3 : 1;
      if (std::uniform_int_distribution(0, 5000)(engine) == 0) tick = 0;
      auto given = input(tick, draw(20.0), draw(1.0), draw(30.0));
      if (std::uniform_int_distribution(0, 100)(engine) == 0) given.sensed_flags = kInputStale;
      given.permitted = std::uniform_int_distribution(0, 200)(engine) != 0;
      const CountermeasureOutput out = sut.step(given);
      ASSERT_LE(std::abs(out.force_n), limits.max_force_n);
      // Down as fast as the ramp, otherwise by the slew.
      const double most = std::max(limits.max_slew_n_s * 1e-3,
                                   limits.max_force_n / static_cast<double>(limits.ramp_ticks));
      ASSERT_LE(std::abs(out.force_n - last_n), most + 1e-9);
      ASSERT_TRUE(std::isfinite(out.command_rad));
      last_n = out.force_n;
    }
  }
}

// From full force: a lost permission, the end of the trial, an input that is stuck, invalid, not
// finite or impossible.
TEST(CountermeasureTest, TheForceIsZeroWithinTheRampOnceAnythingIsLost) {
  using Loss = std::function<void(CountermeasureInput&, Tick)>;
  const std::vector<std::pair<const char*, Loss>> losses{
      {"permission", [](auto& in, Tick) { in.permitted = false; }},
      {"enabled", [](auto& in, Tick) { in.enabled = false; }},
      {"stuck", [](auto& in, Tick at) { in.tick = at; }},
      {"stale", [](auto& in, Tick) { in.sensed_flags = kInputStale; }},
      {"fault", [](auto& in, Tick) { in.sensed_flags = kFault; }},
      {"nan", [](auto& in, Tick) { in.sensed[1] = NAN; }},
      {"angle", [](auto& in, Tick) { in.sensed[4] = INFINITY; }},
      {"huge", [](auto& in, Tick) { in.sensed[1] = 1000.0; }}};
  const std::int64_t ramp = signal::ForceLimits{}.ramp_ticks;
  for (const Recipe& recipe : recipes()) {
    for (const auto& [name, lose] : losses) {
      Countermeasure sut({}, recipe);
      const auto sample = [](Tick n) {
        const double phase = kTurn * 1.2e-3 * static_cast<double>(n);
        return input(n, 3.0 * std::sin(phase), 0.1 * std::sin(phase), 0.75 * std::cos(phase));
      };
      constexpr Tick kBefore = 20'000;
      double largest_n = 0.0;
      for (Tick n = 1; n <= kBefore; ++n) {
        largest_n = std::max(largest_n, std::abs(sut.step(sample(n)).force_n));
      }
      ASSERT_GT(largest_n, 1.0) << name;
      for (Tick n = kBefore + 1; n <= kBefore + 3 * ramp; ++n) {
        auto given = sample(n);
        lose(given, kBefore);
        const double force_n = sut.step(given).force_n;
        if (n < kBefore + ramp) continue;
        ASSERT_EQ(force_n, 0.0) << name << " " << n - kBefore;
      }
    }
  }
}

double motion_at(Tick n) {
  double sum = 0.0;
  for (int k = 7; k <= 20; ++k) {
    sum += std::sin(kTurn * 0.1e-3 * k * static_cast<double>(n) + k * k);
  }
  return 0.6 * sum;
}

struct Left {
  double stick;    ///< RMS of the stick's motion over that of a motor that is off
  double command;  ///< the same of what the machine gets
};

// A fitted arm as plant, for 80 s of which the last 20 s count.  The motor acts from the sample on.
Left left_of(const Recipe& recipe, const admittance::ArmValues& plant) {
  Countermeasure sut({}, recipe);
  LinearArm with(plant, {});
  LinearArm without(plant, {});
  support::RmsShare moved, commanded;
  double last_m = 0.0;
  for (Tick n = 1; n <= 80'000; ++n) {
    const double a = motion_at(n);
    LinearArm at_sample = with;
    const double x = at_sample.step(a, 0.0).displacement_m;
    const auto out = sut.step(input(n, a, x / kLever_m, (x - last_m) * 1000.0 / kLever_m));
    last_m = x;
    with.step(a, out.force_n);
    const double x0 = without.step(a, 0.0).displacement_m;
    if (n < 60'000) continue;
    moved.add(x, x0);
    commanded.add(kLever_m * out.command_rad, x0);
  }
  return {moved.value(), commanded.value()};
}

// The plant is one of the two arms of the schedule.
TEST(CountermeasureTest, ASchedulesForceStillsTheStickOfAKnownArm) {
  Recipe recipe;
  admittance::ArmValues other = admittance::mean_arm();
  other[admittance::kArmStiffness] *= 0.6;
  recipe.schedule = ScheduleConfig{.relaxed = other, .holding = admittance::mean_arm()};
  const Left sut = left_of(recipe, admittance::mean_arm());
  EXPECT_LT(sut.stick, 0.05);
  EXPECT_NEAR(sut.command, sut.stick, 1e-9);
}

// A damper of 30 N s/m leaves the share of the closed form |Z_s + Z|/|Z_s + Z + 30 s| in the band;
// at 2 Hz the hand's impedance is about 1000 N/m and the damper adds 380j.
TEST(CountermeasureTest, ADamperLeavesWhatItsImpedanceSays) {
  double with = 0.0;
  double without = 0.0;
  for (int k = 7; k <= 20; ++k) {
    const std::complex<double> s(0.0, kTurn * 0.1 * k);
    const auto arm = admittance::arm_response(admittance::mean_arm(), 0.1 * k);
    const std::complex<double> alone = 0.25 * s * s + 0.5 * s + arm.impedance;
    without += std::norm(arm.feedthrough / alone);
    with += std::norm(arm.feedthrough / (alone + 30.0 * s));
  }
  EXPECT_NEAR(left_of(only(kDamper), admittance::mean_arm()).stick, std::sqrt(with / without),
              0.01);
}

// The motor drives the stick by a model that is wrong, and the command knows it.
TEST(CountermeasureTest, WhatTheMotorMovesIsTakenOffTheCommand) {
  Recipe recipe;
  recipe.force = true;
  recipe.model = control_model(model());
  recipe.signal = SignalConfig{.feedthrough_to_position = {1000.0, {0.0}, {1.0}},
                               .moved_by_motor = admittance::mean_arm(),
                               .stick = {}};
  // Nothing but the motor's own motion goes: what is left is that of a motor that is off.
  const Left sut = left_of(recipe, admittance::mean_arm());
  EXPECT_NEAR(sut.command, 1.0, 0.02);
  EXPECT_GT(std::abs(sut.stick - 1.0), 0.1);
}

TEST(CountermeasureTest, ThePredictedSignalMovesNoMotor) {
  Recipe recipe;
  recipe.model = control_model(model());
  recipe.parts = {{PartKind::kPredictedSignal, {1.394, 11.18, 1136.0, kLever_m}}};
  const Left sut = left_of(recipe, admittance::mean_arm());
  EXPECT_NEAR(sut.stick, 1.0, 1e-9);
  EXPECT_GT(std::abs(sut.command - 1.0), 0.1);
}

// With a plant that answers, CC-10 follows it, and the output carries the weights of every tick.
TEST(CountermeasureTest, TheWeightsOfAnAdaptiveForceComeOutWithIt) {
  Recipe recipe;
  recipe.force = true;
  recipe.model = control_model(model());
  const auto weights_after = [&](Tick ticks) {
    Countermeasure sut({}, recipe);
    LinearArm plant(admittance::mean_arm(), {});
    CountermeasureOutput out{};
    for (Tick n = 1; n <= ticks; ++n) {
      LinearArm at_sample = plant;
      const double a = motion_at(n);
      out = sut.step(input(n, a, at_sample.step(a, 0.0).displacement_m / kLever_m, 0.0));
      plant.step(a, out.force_n);
    }
    return out.weights;
  };
  EXPECT_EQ(weights_after(20'000), (AdaptiveGain::Pair{1.0, 0.0}));
  recipe.follow = HandCompliance{1.394, 11.18, 1136.0, kLever_m};
  const auto weights = weights_after(20'000);
  EXPECT_GT(std::abs(weights[0] - 1.0), 0.01);
  EXPECT_NE(weights[1], 0.0);
  // Without the motor against f^, what is left of it says nothing about the model.
  recipe.force = false;
  recipe.parts = {{PartKind::kImpedance, {0.0, 5.0, 0.0}}};
  EXPECT_EQ(weights_after(20'000), (AdaptiveGain::Pair{1.0, 0.0}));
}

// command = (1 - e) theta + e shaped, Eq. MI-6: a tick changes it by what theta and the filter
// change it, and by e's own step, 1/250 up and 7/250 down, of what is taken off.  A filter of 1 Hz
// makes of a stick that moves with 0.4 Hz no faster one; a factor of two is left for its
// transients.
TEST(CountermeasureTest, AFilterOnTheCommandBeginsAndEndsWithoutAJump) {
  constexpr double kTheta_hz = 0.4;
  const auto theta = [](Tick n) {
    return 0.1 + 0.1 * std::sin(kTurn * kTheta_hz * 1e-3 * static_cast<double>(n));
  };
  constexpr double kMost_rad_tick = 0.1 * kTurn * kTheta_hz * 1e-3;
  for (const Part& part : made_parts()) {
    if (!row_of(part.kind)->filters_command) continue;
    const Recipe recipe = only(part);
    // The trial has begun, begins later, or begins again behind samples that are unsound.
    for (const Tick begins : {1, 700}) {
      Countermeasure sut({}, recipe);
      double last_rad = theta(0);
      double most_off_rad = 0.0;
      for (Tick n = 1; n < 9000; ++n) {
        auto given = input(n, 0.0, theta(n), 0.0);
        given.enabled = n >= begins && n < 8000;
        if (n >= 4000 && n < 4400) given.sensed_flags = kInputStale;
        const double command_rad = sut.step(given).command_rad;
        most_off_rad = std::max(most_off_rad, std::abs(theta(n) - command_rad));
        if (n < 4000 || n > 4400) {
          ASSERT_LE(std::abs(command_rad - last_rad),
                    2.0 * kMost_rad_tick + 7.0 / 250.0 * most_off_rad)
              << "tick " << n << " of a trial from " << begins;
        }
        if (n > 8040) {
          ASSERT_EQ(command_rad, theta(n));
        }
        last_rad = command_rad;
      }
      // Any filter takes something off.
      EXPECT_GT(most_off_rad, 0.005);
    }
  }
}

// Each way in which a sample is unsound, with the stick moving on.
std::vector<std::pair<const char*, std::function<void(CountermeasureInput&)>>> unsound() {
  return {{"stale", [](auto& in) { in.sensed_flags = kInputStale; }},
          {"fault", [](auto& in) { in.sensed_flags = kFault; }},
          {"huge", [](auto& in) { in.sensed[1] = 1000.0; }},
          {"accel nan", [](auto& in) { in.sensed[1] = NAN; }},
          {"stuck", [](auto& in) { in.tick = 1; }}};
}

// The cursor must not freeze because of a part that has nothing to do with it.
TEST(CountermeasureTest, WithoutAPartOnTheCommandTheCommandIsTheStickToTheBit) {
  const auto theta = [](Tick n) { return 0.1 * std::sin(kTurn * 0.4e-3 * static_cast<double>(n)); };
  Recipe all = everything();
  all.signal.reset();
  std::erase_if(all.parts, [](const Part& part) { return !row_of(part.kind)->drives_motor; });
  std::vector<Recipe> only_forces = recipes();
  only_forces.front() = all;
  for (const Recipe& recipe : only_forces) {
    for (const auto& [name, spoil] : unsound()) {
      Countermeasure sut({}, recipe);
      for (Tick n = 1; n < 2000; ++n) {
        auto given =
            input(n, 2.0 * std::sin(kTurn * 1.3e-3 * static_cast<double>(n)), theta(n), 0.0);
        if (n > 1000 && (n < 1010 || n > 1500)) spoil(given);
        const CountermeasureOutput out = sut.step(given);
        ASSERT_EQ(out.command_rad, theta(n)) << name << ", tick " << n;
        ASSERT_EQ(out.taken_off_rad, 0.0) << name << ", tick " << n;
      }
    }
    // Beyond its full scale as well; what is no number is no angle.
    Countermeasure sut({}, recipe);
    EXPECT_EQ(sut.step(input(1, 0.0, 50.0, 0.0)).command_rad, 50.0);
    EXPECT_EQ(sut.step(input(2, 0.0, NAN, 0.0)).command_rad, 50.0);
  }
}

// G a of 6 mm, held while e falls by 7/250 a tick: so much, and no more, is the stick's own motion.
TEST(CountermeasureTest, WhatIsTakenOffIsHeldInAnUnsoundSampleAndFadesIfItLasts) {
  constexpr double kPosition_s2 = -0.003;
  constexpr Tick kLost = 2000;
  const auto theta = [](Tick n) { return 0.1 * std::sin(kTurn * 0.4e-3 * static_cast<double>(n)); };
  const auto off = [](double share) { return share * kPosition_s2 * 2.0 / kLever_m; };
  const std::int64_t ramp = signal::ForceLimits{}.ramp_ticks;
  const Recipe recipe{.signal = SignalConfig{{1000.0, {kPosition_s2}, {1.0}}, {}, {}}};
  for (const auto& [name, spoil] : unsound()) {
    for (const Tick lasts : {Tick{1}, Tick{10}, ramp, Tick{500}}) {
      Countermeasure sut({}, recipe);
      for (Tick n = 1; n < kLost + 2000; ++n) {
        auto given = input(n, 2.0, theta(n), 0.0);
        if (n >= kLost && n < kLost + lasts) spoil(given);
        const CountermeasureOutput out = sut.step(given);
        ASSERT_EQ(out.command_rad, theta(n) - out.taken_off_rad);
        if (n < 250) continue;
        const Tick lost = std::clamp<Tick>(n - kLost + 1, 0, lasts);
        const Tick back = std::max<Tick>(n - kLost + 1 - lasts, 0);
        const Tick engaged = std::min<Tick>(std::max<Tick>(250 - 7 * lost, 0) + back, 250);
        ASSERT_NEAR(out.taken_off_rad, off(static_cast<double>(engaged) / 250.0), 1e-12)
            << name << ", tick " << n << ", lost " << lasts;
        if (lost >= ramp && back == 0) {
          ASSERT_EQ(out.taken_off_rad, 0.0);
        }
      }
    }
  }
}

// A model of 1e307 overflows at 3 m/s^2: what was taken off goes to zero and stays there.
TEST(CountermeasureTest, WhatIsNotFiniteIsNotTakenOff) {
  const Recipe recipe{.signal = SignalConfig{{1000.0, {1e307}, {1.0}}, {}, {}}};
  Countermeasure sut({}, recipe);
  for (Tick n = 1; n < 500; ++n) sut.step(input(n, 1e-307, 0.2, 0.0));
  ASSERT_NE(sut.step(input(500, 1e-307, 0.2, 0.0)).taken_off_rad, 0.0);
  for (Tick n = 501; n < 1000; ++n) {
    const CountermeasureOutput out = sut.step(input(n, 3.0, 0.2, 0.0));
    ASSERT_TRUE(std::isfinite(out.command_rad));
    if (n > 541) {
      ASSERT_EQ(out.command_rad, 0.2);
    }
  }
}

TEST(CountermeasureTest, NothingDoesNothing) {
  const Left sut = left_of({}, admittance::mean_arm());
  EXPECT_DOUBLE_EQ(sut.stick, 1.0);
  EXPECT_DOUBLE_EQ(sut.command, 1.0);
}

// A pole of 0.99 falls to 1 % in ln 0.01/ln 0.99 = 458.2 ticks; those of model() have a radius of
// exp(-0.3 2 pi 3 Hz 1 ms) each: 814.4 ticks.
TEST(CountermeasureTest, ItKnowsHowLongItsModelsSettle) {
  Recipe recipe = only(kDamper);
  EXPECT_EQ(Countermeasure({}, recipe).settle_ticks(), 0);
  recipe.signal = SignalConfig{{1000.0, {1e-5, 0.0}, {1.0, -0.99}}, {}, {}};
  EXPECT_EQ(Countermeasure({}, recipe).settle_ticks(), 459);
  recipe.force = true;
  recipe.model = control_model(model());
  EXPECT_EQ(Countermeasure({}, recipe).settle_ticks(), 815);
}

TEST(CountermeasureTest, RefusesAnUnsoundModel) {
  Recipe recipe;
  signal::DifferenceModel unstable = model();
  unstable.denominator = {1.0, -2.1, 1.2};
  recipe.model = control_model(unstable);
  EXPECT_THROW(Countermeasure({}, recipe), ConfigError);
  recipe = {};
  // Another rate; a numerator that is too short.
  for (const auto& each : {unstable, signal::DifferenceModel{50.0, {1e-3}, {1.0}},
                           signal::DifferenceModel{1000.0, {1e-3}, {1.0, -0.9}}}) {
    recipe.signal = SignalConfig{each, {}, {}};
    EXPECT_THROW(Countermeasure({}, recipe), ConfigError);
  }
  recipe = {};
  recipe.lever_m = 0.0;
  EXPECT_THROW(Countermeasure({}, recipe), ConfigError);
}

}  // namespace stillhand::cancellation::countermeasure_test

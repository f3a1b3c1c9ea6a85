// SPDX-License-Identifier: Apache-2.0
// A control model in the canceller: Eq. CC-6 to CC-9 and CC-14.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <utility>

#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/identification/rate_conversion.hpp"
#include "services/core/signal/random.hpp"
#include "tests/support/feedthrough_records.hpp"

namespace stillhand::cancellation::control_model_test {
namespace {

constexpr std::size_t kA_y = static_cast<std::size_t>(Channel::kAccelY);
constexpr std::size_t kRoll_i = static_cast<std::size_t>(Channel::kRoll);
constexpr ModelBounds kBounds{60.0, 10.0};

// z'' = u - c z' - k z - spring(z) by Euler's two half steps: poles well inside the unit circle.
ControlModel oscillator() {
  ControlModel model;
  model.rate_hz = 1000.0;
  model.denominator = {1.0, -1.99, 0.9902};
  model.inputs = {{Channel::kAccelY, {}, {0.0, 2e-4, 0.0}}};
  return model;
}

ValueMap table_of(double low, double high, double (*map)(double)) {
  ValueMap out{low, high, {}};
  for (int i = 0; i <= 100; ++i) out.values.push_back(map(low + (high - low) * i / 100.0));
  return out;
}

ChannelSample at(double a_y, double roll = 0.0) {
  ChannelSample sample{};
  sample[kA_y] = a_y;
  sample[kRoll_i] = roll;
  return sample;
}

double total(const ControlModelFilter::Force& force) {
  return force.feedthrough_n + force.beside_n;
}

TEST(ControlModelFilterTest, ASecondInputAddsItsOwnResponse) {
  ControlModel model = oscillator();
  model.inputs.push_back({Channel::kRoll, {}, {2e-3, 1e-3, 1e-3}});
  ControlModelFilter both(model, 1);
  ControlModelFilter first(control_model(path_model(model, model.inputs[0])), 1);
  ControlModelFilter second(control_model(path_model(model, model.inputs[1])), 1);
  signal::Gaussian draw(1, 1);
  for (Tick n = 0; n < 2000; ++n) {
    const double a_y = draw();
    const double roll = 0.1 * draw();
    ASSERT_NEAR(total(both.step(at(a_y, roll), n)),
                total(first.step(at(a_y), n)) + total(second.step(at(roll), n)), 1e-12);
  }
}

TEST(ControlModelFilterTest, AMapIsStraightBetweenItsValuesAndBeyondThem) {
  const ValueTable table({-1.0, 1.0, {2.0, 0.0, 4.0}});
  EXPECT_DOUBLE_EQ(table(-1.0), 2.0);
  EXPECT_DOUBLE_EQ(table(-0.5), 1.0);
  EXPECT_DOUBLE_EQ(table(0.5), 2.0);
  EXPECT_DOUBLE_EQ(table(2.0), 8.0);
  EXPECT_DOUBLE_EQ(table(-2.0), 4.0);
  EXPECT_DOUBLE_EQ(ValueTable()(0.3), 0.3);
}

TEST(ControlModelFilterTest, PathsAndWavesActBesideTheBody) {
  ControlModel model = control_model({1000.0, {0.0}, {1.0}});
  model.paths = {{Channel::kRoll, 0.5, {}, 4.0}};
  model.waves = {{std::nullopt, 10.0, 0.3, 0.4}, {Channel::kTheta, 14.0, 0.0, 1.0}};
  ControlModelFilter sut(model, 1);
  ChannelSample sample = at(0.0, 0.2);
  sample[static_cast<std::size_t>(Channel::kTheta)] = 1.0 / 28.0;  // half a period
  double force_n = 0.0;
  for (Tick n = 0; n <= 5025; ++n) force_n = total(sut.step(sample, n));
  // 10 Hz at 5.025 s: a quarter of a period; the lag has settled to 5e-5.
  EXPECT_NEAR(force_n, 4.0 * 0.2 + 0.3 - 1.0, 1e-4);
}

// Of a path: w(0.2 rad / 0.1 rad) = 1 after the way up, and 1 - 0.05/0.1 on the way back.
TEST(ControlModelFilterTest, APathWithMemoryGoesBackAnotherWay) {
  ControlModel model = control_model({1000.0, {0.0}, {1.0}});
  model.paths = {{Channel::kRoll, 0.0, {}, 4.0}};
  model.hysteresis = {{0, signal::HysteresisOperator::kStop, 0.1, -1.0, 1.0}};
  ControlModelFilter sut(model, 1);
  Tick tick = 0;
  const auto go = [&](double roll) { return total(sut.step(at(0.0, roll), tick++)); };
  EXPECT_DOUBLE_EQ(go(0.0), 0.0);
  EXPECT_DOUBLE_EQ(go(0.05), 2.0);
  EXPECT_DOUBLE_EQ(go(0.2), 4.0);
  EXPECT_DOUBLE_EQ(go(0.15), 2.0);
  EXPECT_DOUBLE_EQ(go(0.0), -4.0);
  EXPECT_DOUBLE_EQ(go(7.0), 4.0);
  EXPECT_DOUBLE_EQ(go(1.0), 4.0) << "held at 1: coming back from 7 is no motion";
  sut.reset();
  EXPECT_DOUBLE_EQ(go(0.7), 0.0) << "from rest where it is";
}

// At the rate of the model that was fitted: phi changes at multiples of its ticks alone.  Of a body
// that passes its input on at once, z = v, y = v + phi.
TEST(ControlModelFilterTest, ASpringHoldsItsValueBetween) {
  ControlModel model = control_model({1000.0, {1.0, 0.0}, {1.0, 0.0}});
  model.loop = LoopPath{{1.0, 0.0}, {1.0, 0.0}, {0.0, 0.0}, {-9.0, 9.0, {-90.0, 90.0}}, 10};
  ControlModelFilter sut(model, 1);
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.5), 7)), 0.5) << "nothing is held yet";
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.5), 10)), 5.5);
  for (Tick tick = 11; tick < 20; ++tick) EXPECT_DOUBLE_EQ(total(sut.step(at(0.2), tick)), 5.2);
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.2), 20)), 2.2);
  sut.reset();
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.2), 21)), 0.2);
}

// Against the plain difference equations A z = N v + M phi(z), A y = C v + E phi(z), with a map, or
// with the operator that the diagnosis fits with.
TEST(ControlModelFilterTest, ASpringInsideTheBodyIsThatOfEq7AndEq19) {
  using signal::HysteresisOperator;
  constexpr double kThreshold = 0.7;
  constexpr double kEnd = 4.0;
  for (const auto operation : {std::optional<HysteresisOperator>{},
                               {HysteresisOperator::kStop},
                               {HysteresisOperator::kDahl}}) {
    ControlModel model = oscillator();
    model.loop = LoopPath{{0.01, -0.02, 0.005}, {0.0, 1e-3, 1e-3}, {0.0, -2e-4, 0.0}, {}};
    if (operation) {
      model.hysteresis = {{std::nullopt, *operation, kThreshold, -kEnd, kEnd}};
    } else {
      model.loop->phi = table_of(-2.0, 2.0, [](double z) { return z * z * z; });
    }
    ControlModelFilter sut(model, 1);
    const LoopPath& loop = *model.loop;
    const ValueTable phi(loop.phi);
    const auto& c = model.inputs[0].numerator;
    const auto& d = model.denominator;
    signal::HysteresisMemory memory;
    double v1 = 0.0, v2 = 0.0, z1 = 0.0, z2 = 0.0, p1 = 0.0, p2 = 0.0, y1 = 0.0, y2 = 0.0;
    signal::Gaussian draw(2, 1);
    double farthest = 0.0;
    for (Tick n = 0; n < 3000; ++n) {
      const double v = 3.0 * std::sin(0.02 * static_cast<double>(n)) + draw();
      const double z = loop.n[0] * v + loop.n[1] * v1 + loop.n[2] * v2 + loop.m[1] * p1 +
                       loop.m[2] * p2 - d[1] * z1 - d[2] * z2;
      farthest = std::max(farthest, std::abs(z));
      const double p =
          operation ? signal::step_of(*operation)(std::clamp(z, -kEnd, kEnd) / kThreshold, memory)
                    : phi(z);
      const double y = c[0] * v + c[1] * v1 + c[2] * v2 + loop.e[0] * p + loop.e[1] * p1 +
                       loop.e[2] * p2 - d[1] * y1 - d[2] * y2;
      // Sums of numbers below 100 in another order, through poles of radius 0.995: 200 roundings.
      ASSERT_NEAR(total(sut.step(at(v), n)), y, 1e-9 * (1.0 + std::abs(y))) << n;
      v2 = v1, v1 = v, z2 = z1, z1 = z, p2 = p1, p1 = p, y2 = y1, y1 = y;
    }
    EXPECT_GT(farthest, operation ? kEnd : 0.0);
  }
}

// A lag next to the body has no transient of a level that was there before.
TEST(ControlModelFilterTest, ALagStartsWhereItsChannelIs) {
  ControlModel model = control_model({1000.0, {0.0}, {1.0}});
  model.paths = {{Channel::kRoll, 5.0, {}, 4.0}};
  ControlModelFilter sut(model, 1);
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.0, 0.3), 0)), 1.2);
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.0, 0.3), 1)), 1.2);
  EXPECT_NEAR(total(sut.step(at(0.0, 0.0), 2)), 1.2 * std::exp(-1e-3 / 5.0), 1e-12);
  sut.reset();
  EXPECT_DOUBLE_EQ(total(sut.step(at(0.0, 0.1), 3)), 0.4);
}

// Eq. CC-14.  Critical damping of 1 kg on 2500 N/m is 100 N s/m.
TEST(ModelCheckTest, AHandHasTheSizeOfAPersons) {
  const HandCompliance right[]{{1.0, 50.0, 2500.0, 0.1}, {0.1, 5.0, 2500.0, 0.02},
                               {10.0, 20.0, 50.0, 0.5},  {1.0, 1.01, 2500.0, 0.1},
                               {1.0, 99.9, 2500.0, 0.1}, {1.0, 50.0, 10'000.0, 0.1}};
  const HandCompliance wrong[]{{0.09, 5.0, 2500.0, 0.1},   {10.1, 50.0, 2500.0, 0.1},
                               {1.0, 5.0, 49.0, 0.1},      {1.0, 50.0, 10'001.0, 0.1},
                               {1.0, 0.99, 2500.0, 0.1},   {1.0, 100.0, 2500.0, 0.1},
                               {1.0, 50.0, 2500.0, 0.019}, {1.0, 50.0, 2500.0, 0.51}};
  for (const HandCompliance& hand : right) EXPECT_TRUE(is_hand(hand)) << hand.damping_n_s_m;
  for (const HandCompliance& hand : wrong) EXPECT_FALSE(is_hand(hand)) << hand.damping_n_s_m;
}

Refusal refusal_of(const ControlModel& model) { return check_model(model, kBounds).refusal; }

TEST(ModelCheckTest, APushWithoutMotionIsRefusedWhereverItComesFrom) {
  const ValueMap push{-20.0, 20.0, {5.0, 5.0}};
  ControlModel behind = oscillator();
  behind.output = push;
  EXPECT_EQ(refusal_of(behind), Refusal::kRest);
  ControlModel before = oscillator();
  before.inputs[0].map = push;
  before.inputs[0].numerator = {1.0, -1.98, 0.982};  // 10 N at rest
  EXPECT_EQ(refusal_of(before), Refusal::kRest);
  ControlModel beside = oscillator();
  beside.paths = {{Channel::kAccelX, 0.05, push, 1.0}};
  EXPECT_EQ(refusal_of(beside), Refusal::kRest);
  beside.paths[0].gain = 0.1;
  EXPECT_EQ(refusal_of(beside), Refusal::kNone);
}

TEST(ModelCheckTest, WhatOnePathMayNotAskForSeveralMayNotEither) {
  ControlModel model = oscillator();
  model.paths = {{Channel::kAccelX, 0.0, {}, 35.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.paths.push_back(model.paths[0]);
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  model.paths[1].channel = Channel::kAccelZ;
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.paths.clear();
  model.inputs.push_back(model.inputs[0]);
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  const double gain = std::abs(signal::response_at(path_model(model, model.inputs[0]), 0.0));
  for (InputPath& input : model.inputs) {
    for (double& c : input.numerator) c *= 0.6 * kBounds.max_gain_n_s2_m / gain;
  }
  EXPECT_EQ(refusal_of(model), Refusal::kGain);
  model = oscillator();
  model.waves = {{std::nullopt, 9.0, 6.0, 0.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.waves.push_back({Channel::kTheta, 9.0, 6.0, 0.0});
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
}

TEST(ControlModelTest, WhatIsTooStrongIsRefused) {
  EXPECT_EQ(refusal_of(oscillator()), Refusal::kNone);
  ControlModel model = oscillator();
  model.paths = {{Channel::kTheta, 0.0, {}, 16.0}};  // 9.6 N at 0.6 rad
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.paths[0].gain = 17.0;
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  // A map by its largest value within 0.6 rad: 0.2 13 + 0.8 8 = 9 at -0.6, or 9 at the knot -0.5.
  for (const std::vector<double>& values :
       {std::vector{13.0, 8.0, 0.0, 0.0, 8.0}, std::vector{0.0, 9.0, 0.0, 0.0, 8.0}}) {
    model.paths[0].map = {-1.0, 1.0, values};
    for (const double gain : {1.1, 1.2}) {
      model.paths[0].gain = gain;
      EXPECT_EQ(refusal_of(model), gain < 1.15 ? Refusal::kNone : Refusal::kPath) << values[0];
    }
  }
  model.paths = {{Channel::kAccelX, 0.0, {}, -59.0}, {Channel::kRoll, 0.1, {}, 588.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.paths[1].gain = 590.0;  // above 60 g
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  model.paths[1].gain = 0.0;
  model.paths[0].gain = -61.0;
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  model = oscillator();
  model.waves = {{std::nullopt, 8.0, 8.0, 7.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  model = oscillator();
  model.inputs.push_back({Channel::kOmega, {}, {0.0, 1e-3, 0.0}});
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  model = oscillator();
  model.inputs[0].map = {-20.0, 20.0, {-2000.0, 0.0, 2000.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kGain);
  model = oscillator();
  model.output = {-20.0, 20.0, {-2000.0, 0.0, 2000.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kGain);
}

TEST(ControlModelTest, ASpringThatLosesStabilityAtOneSlopeIsRefused) {
  ControlModel model = oscillator();
  LoopPath loop;
  loop.e = {0.0, 1e-4, 0.0};
  loop.n = {0.0, 2e-4, 0.0};
  loop.m = {0.0, -2e-4, 0.0};
  loop.phi = table_of(-1.0, 1.0, [](double z) { return std::tanh(3.0 * z); });
  model.loop = loop;
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.loop->m[1] = 2e-3;  // pushes away instead of back
  EXPECT_EQ(refusal_of(model), Refusal::kLoop);
  model.loop->m[1] = -2e-4;
  model.loop->phi.values[40] = -1e9;
  EXPECT_EQ(refusal_of(model), Refusal::kLoop);
}

// Force that nobody moves for is bounded, however many elements and waves share it.
TEST(ControlModelTest, WhatElementsWithMemoryHoldAtRestIsBounded) {
  ControlModel model = oscillator();
  model.paths = {{Channel::kTheta, 0.0, {}, 6.0}, {Channel::kRoll, 0.0, {}, 3.0}};
  model.hysteresis = {{0, signal::HysteresisOperator::kStop, 1e-3, -1.0, 1.0},
                      {1, signal::HysteresisOperator::kDahl, 1e-3, -1.0, 1.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kNone) << "steep, but no stronger than its ends";
  model.paths[1].gain = 4.1;  // 10.1 N, and 10 N are allowed
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  model.paths[1].gain = 3.0;
  model.waves = {{std::nullopt, 8.0, 1.1, 0.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
}

TEST(ControlModelTest, ASpringWithMemoryMayHoldAForceAndNotSwing) {
  ControlModel model = oscillator();
  // z'' = v - c z' - (1 + 1) k z up to its threshold: it yields at 0.5.
  model.loop = LoopPath{{0.0, -1e-4, 0.0}, {0.0, 2e-4, 0.0}, {0.0, -1e-4, 0.0}, {}};
  model.hysteresis = {{std::nullopt, signal::HysteresisOperator::kStop, 0.5, -99.0, 99.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.loop->m[1] = 2e-4;  // pushes away instead of back
  EXPECT_EQ(refusal_of(model), Refusal::kLoop);
  model.loop->m[1] = -1e-4;
  model.loop->e[1] = -1.9e-3;  // at rest 1.9e-3 / 2e-4 = 9.5 N, and 10 N are allowed
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
  model.loop->e[1] = -2.1e-3;
  EXPECT_EQ(refusal_of(model), Refusal::kPath);
  // Pushed to one side alone it stays there: it holds all of its force, and does not swing.
  model.loop->e[1] = -1.9e-3;
  model.inputs[0].map = {-20.0, 20.0, {0.0, 0.0, 20.0}};
  EXPECT_EQ(refusal_of(model), Refusal::kNone);
}

TEST(ControlModelTest, WhatIsNoModelIsRefused) {
  const auto spoilt = [](const auto& spoil) {
    ControlModel model = oscillator();
    model.loop = LoopPath{{0.0, 0.0, 0.0}, {}, {}, {-1.0, 1.0, {-1.0, 1.0}}};
    model.paths = {{Channel::kRoll, 0.0, {}, 1.0}};
    model.waves = {{Channel::kTheta, 10.0, 0.1, 0.1}};
    model.adapts = HandCompliance{1.38, 9.5, 844.0, 0.1};
    model.hysteresis = {{0, signal::HysteresisOperator::kDahl, 0.1, -1.0, 1.0},
                        {std::nullopt, signal::HysteresisOperator::kStop, 0.5, -1.0, 1.0}};
    spoil(model);
    return refusal_of(model);
  };
  const auto nothing = [](ControlModel&) {};
  EXPECT_EQ(spoilt(nothing), Refusal::kNone);
  EXPECT_EQ(spoilt([](auto& m) { m.inputs.clear(); }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.inputs[0].channel = Channel::kRoll; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.inputs[0].channel = static_cast<Channel>(77); }),
            Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->e[0] = 1.0; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->phi.values.resize(1); }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->phi.high = -1.0; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.paths[0].lag_s = -1.0; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.paths[0].gain = std::nan(""); }), Refusal::kNotFinite);
  EXPECT_EQ(spoilt([](auto& m) { m.waves[0].frequency = HUGE_VAL; }), Refusal::kNotFinite);
  EXPECT_EQ(spoilt([](auto& m) { m.adapts->mass_kg = std::nan(""); }), Refusal::kNotFinite);
  EXPECT_EQ(spoilt([](auto& m) { m.adapts->stiffness_n_m = 1.0; }), Refusal::kCompliance);
  EXPECT_EQ(spoilt([](auto& m) { m.adapts->damping_n_s_m = 5e-324; }), Refusal::kCompliance);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].path = 1; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].path = SIZE_MAX; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].path.reset(); }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop.reset(); }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].threshold = 0.0; }), Refusal::kNotFinite);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].threshold = -1.0; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].low = 1.0; }), Refusal::kMalformed);
  // A loop through the output has e alone, of the body's length; one inside has n and m as long.
  EXPECT_EQ(spoilt([](auto& m) { m.loop->e.push_back(0.0); }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->n = {0.0, 0.0, 0.0}; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->m = {0.0, 0.0, 0.0}; }), Refusal::kMalformed);
  const auto inside = [](auto& m) {
    m.loop->e = {0.0, 0.0, 0.0};
    m.loop->n = {1e-6, 0.0, 0.0};
    m.loop->m = {0.0, 1e-6, 0.0};
  };
  EXPECT_EQ(spoilt(inside), Refusal::kNone);
  EXPECT_EQ(spoilt([&](auto& m) { inside(m), m.loop->m[0] = 1e-6; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([&](auto& m) { inside(m), m.loop->n.pop_back(); }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->ticks = 0; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->ticks = 201; }), Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].high = std::nan(""); }), Refusal::kNotFinite);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis[0].threshold = 1e-320; }), Refusal::kNotFinite);
  EXPECT_EQ(spoilt([](auto& m) {
              m.hysteresis[0].operation = static_cast<signal::HysteresisOperator>(2);
            }),
            Refusal::kMalformed);
  EXPECT_EQ(spoilt([](auto& m) { m.hysteresis.resize(8, m.hysteresis[0]); }), Refusal::kTooMany);
  EXPECT_EQ(spoilt([](auto& m) { m.waves.resize(7, m.waves[0]); }), Refusal::kTooMany);
  EXPECT_EQ(spoilt([](auto& m) { m.loop->phi.values.resize(130, 1.0); }), Refusal::kTooMany);
}

// Reported, not judged: a machine's speed is no property of the code.
TEST(ForceTest, CostOfAStepIsReported) {
  ControlModel full = oscillator();
  full.inputs.resize(4, full.inputs[0]);
  full.loop = LoopPath{{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {-1.0, 1.0, {-1.0, 1.0}}};
  full.paths.resize(6, {Channel::kRoll, 0.1, {}, 1.0});
  full.waves.resize(6, {std::nullopt, 10.0, 0.1, 0.1});
  full.hysteresis = {{std::nullopt, signal::HysteresisOperator::kDahl, 1.0, -9.0, 9.0}};
  for (std::size_t i = 0; i < 6; ++i) {
    full.hysteresis.push_back({i, signal::HysteresisOperator::kDahl, 0.1, -1.0, 1.0});
  }
  full.adapts = HandCompliance{1.38, 9.5, 844.0, 0.1};
  const ControlModel papers =
      control_model(identification::to_control_rate(support::body_like_model()).model);
  for (const auto& [name, model] : {std::pair{"the paper's model", papers}, {"everything", full}}) {
    Countermeasure sut({}, {.force = true});
    ASSERT_EQ(sut.load_model(model), Refusal::kNone);
    double sum = 0.0;
    constexpr Tick kSteps = 500'000;
    const auto begin = std::chrono::steady_clock::now();
    for (Tick n = 0; n < kSteps; ++n) {
      sum +=
          sut.step({n, at(std::sin(0.01 * static_cast<double>(n))), kGood, true, true, {}}).force_n;
    }
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - begin;
    std::printf("Countermeasure::step with %s %.0f ns\n", name, took.count() / kSteps);
    EXPECT_TRUE(std::isfinite(sum));
  }
}

TEST(ForceTest, AToneIsAnsweredOnTheSampleClock) {
  ControlModel model = control_model({1000.0, {0.0}, {1.0}});
  model.waves = {{std::nullopt, 7.0, 2.0, 0.0}};
  Countermeasure sut({}, {.force = true});
  ASSERT_EQ(sut.load_model(model), Refusal::kNone);
  for (Tick n = 100'000; n < 104'000; ++n) {
    if (n >= 103'000 && n < 103'010) continue;  // lost samples don't shift it
    const auto out = sut.step({n, at(0.0), kGood, true, true, {}});
    if (n < 103'600) continue;
    ASSERT_NEAR(out.force_n, -2.0 * std::sin(kTwoPi * 7.0 * static_cast<double>(n) / 1000.0), 1e-9);
  }
}

}  // namespace
}  // namespace stillhand::cancellation::control_model_test

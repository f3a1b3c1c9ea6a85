// SPDX-License-Identifier: Apache-2.0
// The maps of input and output, Eq. DG-3 and DG-7: their equations, their ends, their slopes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::diagnosis::effect_maps_test {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Effect limit_of(const char* kind, const char* form, double limit) {
  return {kind, form, {"u"}, {{"limit", "N", limit, 0.01, 9.0}}, {}};
}
Effect two_limits(double up, double down) {
  return {"output_saturation",
          "hard, two limits",
          {},
          {{"upper_limit", "N", up, 0.0, 9.0}, {"lower_limit", "N", down, -9.0, 0.0}},
          {}};
}
Effect play(const char* form, double half_width) {
  return {"dead_zone", form, {"u"}, {{"half_width", "N", half_width, 0.0, 9.0}}, {}};
}
Effect slopes(const char* form, double change) {
  return {"asymmetry", form, {}, {{"slope_change", "-", change, -0.9, 0.9}}, {}};
}
Effect cubic(double kappa) {
  return {"nonlinear_stiffness", "at the output", {}, {{"cubic", "1/N^2", kappa, -1.0, 1.0}}, {}};
}

double mapped(const Effect& effect, double x) { return effect_kind(effect.kind).mapped(effect, x); }
double slope(const Effect& effect, double x) { return effect_kind(effect.kind).slope(effect, x); }

std::vector<double> values(std::size_t count, double size, std::uint64_t seed) {
  signal::Gaussian next(seed, 0);
  std::vector<double> x(count);
  for (double& value : x) value = size * (2.0 * next.uniform() - 1.0);
  return x;
}

struct OutputMap {
  Effect effect;
  std::vector<double> kinks;  ///< where there is no derivative
};

std::vector<OutputMap> output_maps() {
  return {{limit_of("output_saturation", "hard", 1.3), {-1.3, 1.3}},
          {limit_of("output_saturation", "soft", 1.3), {}},
          {limit_of("output_saturation", "clip above", 0.4), {0.4}},
          {limit_of("output_saturation", "clip below", -0.3), {-0.3}},
          {two_limits(0.7, -1.9), {-1.9, 0.7}},
          {play("at the output", 0.4), {-0.4, 0.4}},
          {slopes("slopes at the output", 0.35), {0.0}},
          {slopes("slopes at the output", -0.9), {0.0}},
          {{"asymmetry", "size at the output", {}, {}, {}}, {0.0}},
          {cubic(0.05), {}},
          {cubic(-0.05), {-1.0 / std::sqrt(0.15), 1.0 / std::sqrt(0.15)}}};
}

// Central differences with h = 1e-5: h^2/6 of the third derivative, at most 1.2, and rounding of
// 1e-16 3/h: below 1e-10.
TEST(EffectMapsTest, TheSlopeOfAnOutputMapIsItsDerivative) {
  constexpr double kStep = 1e-5;
  for (const OutputMap& sut : output_maps()) {
    for (const double y : values(500, 3.0, 1)) {
      if (std::ranges::any_of(sut.kinks, [&](double k) { return std::abs(y - k) < 2.0 * kStep; })) {
        continue;
      }
      const double difference =
          (mapped(sut.effect, y + kStep) - mapped(sut.effect, y - kStep)) / (2.0 * kStep);
      ASSERT_NEAR(slope(sut.effect, y), difference, 1e-9)
          << sut.effect.kind << ", " << sut.effect.form << " at " << y;
    }
  }
}

// Of the others the size of the output turns back by its meaning.
TEST(EffectMapsTest, NoMapThatKeepsTheSignFallsAnywhere) {
  std::vector<double> y = values(500, 4.0, 2);
  std::ranges::sort(y);
  std::vector<Effect> all{limit_of("input_saturation", "hard", 0.8),
                          limit_of("input_saturation", "soft", 0.8), play("at the input", 0.3),
                          slopes("slopes at the input", -0.9)};
  for (const OutputMap& each : output_maps()) {
    if (mapped(each.effect, -1.0) < 0.0) all.push_back(each.effect);
  }
  for (const Effect& sut : all) {
    for (std::size_t n = 1; n < y.size(); ++n) {
      ASSERT_LE(mapped(sut, y[n - 1]), mapped(sut, y[n])) << sut.kind << ", " << sut.form;
    }
  }
}

TEST(EffectMapsTest, AHardLimitLetsEverythingThroughUpToItself) {
  constexpr double kLimit = 0.7;
  for (const char* kind : {"input_saturation", "output_saturation"}) {
    const Effect sut = limit_of(kind, "hard", kLimit);
    EXPECT_EQ(mapped(sut, kLimit), kLimit);
    EXPECT_EQ(mapped(sut, std::nextafter(kLimit, 0.0)), std::nextafter(kLimit, 0.0));
    EXPECT_EQ(mapped(sut, std::nextafter(kLimit, 1.0)), kLimit);
    EXPECT_EQ(mapped(sut, kInfinity), kLimit);
    EXPECT_EQ(mapped(sut, -kInfinity), -kLimit);
    EXPECT_TRUE(std::isnan(mapped(sut, std::nan(""))));
  }
}

TEST(EffectMapsTest, TwoLimitsActEachOnItsSide) {
  const Effect sut = two_limits(0.5, -2.0);
  EXPECT_EQ(mapped(sut, 3.0), 0.5);
  EXPECT_EQ(mapped(sut, -1.5), -1.5);
  EXPECT_EQ(mapped(sut, -3.0), -2.0);
  EXPECT_EQ(slope(sut, 0.49), 1.0);
  EXPECT_EQ(slope(sut, 0.5), 0.0) << "at the limit the parameter moves the output, not y";
  EXPECT_EQ(slope(sut, -2.0), 0.0);
  const Effect above = limit_of("output_saturation", "clip above", 0.4);
  EXPECT_EQ(mapped(above, 1.0), 0.4);
  EXPECT_EQ(mapped(above, -9.0), -9.0);
  const Effect below = limit_of("output_saturation", "clip below", -0.3);
  EXPECT_EQ(mapped(below, 9.0), 9.0);
  EXPECT_EQ(mapped(below, -1.0), -0.3);
}

// phi(z), z in thresholds; a stop counts z from its limit.
TEST(EffectMapsTest, ANonlinearityInsideTheBodyIsItsLaw) {
  struct Law {
    const char* kind;
    const char* form;
    double (*phi)(double);
  };
  for (const Law& sut : {
           Law{"nonlinear_stiffness", "cubic of the output", [](double z) { return z * z * z; }},
           {"nonlinear_stiffness", "bent of the output",
            [](double z) { return z * z * z / (1.0 + z * z); }},
           {"nonlinear_stiffness", "levelled of the output",
            [](double z) { return z - std::tanh(z); }},
           {"output_saturation", "stop above", [](double z) { return std::max(z, 0.0); }},
           {"output_saturation", "stop below", [](double z) { return std::min(z, 0.0); }},
       }) {
    const Nonlinearity law =
        effect_kind(sut.kind).feedback({sut.kind, sut.form, {}, {{"threshold", "N", 0.5}}, {}});
    EXPECT_EQ(law.stop.value_or(law.threshold), 0.5) << sut.form;
    LoopMemory none;
    for (const double z : {-3.0, -0.7, 0.0, 0.4, 2.0}) {
      EXPECT_NEAR(law.phi(z, none), sut.phi(z), 1e-14) << sut.form << " at " << z;
    }
  }
}

// L tanh(y/L) = y - y^3/(3 L^2) + 2 y^5/(15 L^4) - ..., alternating: between two partial sums.
TEST(EffectMapsTest, ASoftLimitIsCubicForSmallAndLevelForLargeValues) {
  constexpr double kLimit = 1.25;
  for (const char* kind : {"input_saturation", "output_saturation"}) {
    const Effect sut = limit_of(kind, "soft", kLimit);
    for (const double y : {0.01, 0.05, 0.2}) {
      const double cube = y - y * y * y / (3.0 * kLimit * kLimit);
      EXPECT_GT(mapped(sut, y), cube);
      EXPECT_LT(mapped(sut, y), cube + 2.0 * std::pow(y, 5) / (15.0 * std::pow(kLimit, 4)));
    }
    for (const double y : values(100, 5.0, 4)) EXPECT_LT(std::abs(mapped(sut, y)), kLimit);
    EXPECT_EQ(mapped(sut, 1e300), kLimit);
    EXPECT_EQ(mapped(sut, -1e300), -kLimit);
  }
}

TEST(EffectMapsTest, PlayBeginsBeyondItsHalfWidth) {
  constexpr double kHalf = 0.25;
  const Effect sut = play("at the input", kHalf);
  EXPECT_EQ(mapped(sut, kHalf), 0.0);
  EXPECT_EQ(mapped(sut, -kHalf), 0.0);
  EXPECT_GT(mapped(sut, std::nextafter(kHalf, 1.0)), 0.0);
  EXPECT_EQ(mapped(sut, 1.0), 0.75);
  EXPECT_EQ(mapped(sut, -1.0), -0.75);
  EXPECT_EQ(mapped(play("at the input", 0.0), 0.3), 0.3) << "without play nothing is lost";
}

TEST(EffectMapsTest, SlopesDifferBySign) {
  const Effect sut = slopes("slopes at the output", 0.25);
  EXPECT_EQ(mapped(sut, 2.0), 2.5);
  EXPECT_EQ(mapped(sut, -2.0), -1.5);
  EXPECT_EQ(mapped(sut, 0.0), 0.0);
  EXPECT_EQ(slope(sut, 2.0), 1.25);
  EXPECT_EQ(slope(sut, -2.0), 0.75);
}

// y + kappa y^3 with kappa < 0 rises up to y_0 = 1/sqrt(-3 kappa), to 2/3 y_0.
TEST(EffectMapsTest, ASofteningCubicStaysAtItsHighestValue) {
  for (const double kappa : {-0.01, -0.3, -2.0}) {
    const Effect sut = cubic(kappa);
    const double end = 1.0 / std::sqrt(-3.0 * kappa);
    EXPECT_NEAR(mapped(sut, end), 2.0 / 3.0 * end, 1e-15 * end * 4.0);
    EXPECT_EQ(mapped(sut, 1.5 * end), mapped(sut, end));
    EXPECT_EQ(mapped(sut, 1e200), mapped(sut, end));
    EXPECT_EQ(slope(sut, 1.5 * end), 0.0);
    EXPECT_EQ(slope(sut, 0.0), 1.0);
  }
}

TEST(EffectMapsTest, TheFormSaysWhereAMapActs) {
  const auto stage = [](const Effect& effect) { return effect_kind(effect.kind).stage(effect); };
  EXPECT_EQ(stage(play("at the input", 0.1)), Stage::kInputValue);
  EXPECT_EQ(stage(play("at the output", 0.1)), Stage::kOutputValue);
  EXPECT_EQ(stage(play("beside the body", 0.1)), Stage::kTerm) << "it reads a channel";
  EXPECT_EQ(stage(slopes("slopes at the input", 0.1)), Stage::kInputValue);
  EXPECT_EQ(stage(slopes("slopes at the output", 0.1)), Stage::kOutputValue);
  EXPECT_EQ(stage(slopes("slopes of the output", 0.1)), Stage::kFeedback);
  EXPECT_EQ(stage(cubic(0.1)), Stage::kOutputValue);
}

// A kind without a function of a stage leaves the signal as it is.
TEST(EffectMapsTest, AKindThatActsElsewhereLeavesTheValuesAlone) {
  const Effect sut{"tone", "beside the body", {}, {{"frequency", "Hz", 3.0, 2.0, 4.0}}, {1.0, 0.0}};
  const EffectKind& kind = effect_kind(sut.kind);
  EXPECT_EQ(kind.mapped(sut, 0.37), 0.37);
  EXPECT_EQ(kind.slope(sut, 0.37), 1.0);
  EXPECT_EQ(kind.input_delay_s(sut, 12.0), 0.0);
  const Nonlinearity none = kind.feedback(sut);
  LoopMemory memory;
  EXPECT_EQ(none.phi(5.0, memory), 0.0);
  EXPECT_EQ(none.threshold, 1.0);
}

}  // namespace stillhand::diagnosis::effect_maps_test

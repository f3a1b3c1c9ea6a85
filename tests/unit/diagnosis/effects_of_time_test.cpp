// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "services/core/contract/units.hpp"
#include "tests/unit/diagnosis/proposed.hpp"

// Effects of time alone.  Each on a recording of its own.
namespace stillhand::diagnosis::effects_of_time_test {

using made::expect_proposed;
using made::Planted;

constexpr std::size_t kCount = 6000;
constexpr double kLength_s = 59.99;
const std::vector<double> kU = made::ride(kCount, 1);
const Body kBody = made::two_pole_body();

std::vector<double> answer() { return made::answer(kBody, kU); }

std::vector<double> answer_and(const std::function<double(double t_s)>& more) {
  auto y = answer();
  for (std::size_t n = 0; n < kCount; ++n) y[n] += more(0.01 * static_cast<double>(n));
  return y;
}

std::vector<double> answer_times(const std::function<double(double t_s)>& gain) {
  auto y = answer();
  for (std::size_t n = 0; n < kCount; ++n) y[n] *= gain(0.01 * static_cast<double>(n));
  return y;
}

Planted planted(const char* kind, const char* form, const std::vector<double>& y) {
  return made::planted_in(kind, form, y, kU);
}

std::vector<Proposal> proposed_by(const char* kind, const std::vector<double>& y) {
  const made::Studied of(made::measurement_of({{"u", "V", kU}, {"y", "N", y}}), 2);
  return effect_kind(kind).proposed(of.screening);
}

// Body and noise of a seed.
std::vector<double> answer_with_noise(const std::vector<double>& noise) {
  auto y = answer();
  for (std::size_t n = 0; n < kCount; ++n) y[n] += noise[n];
  return y;
}

TEST(EffectsOfTimeTest, ATone) {
  // Lines are tried in quarters of 1/60 Hz.
  expect_proposed(planted("tone", "beside the body", answer_and([](double t_s) {
                            return 0.1 * std::sin(kTwoPi * 7.3217 * t_s + 0.4);
                          })),
                  {{0, 7.3217, 0.13 / kLength_s, 1e-4}});
}

TEST(EffectsOfTimeTest, NoiseOfAnyColourIsNoTone) {
  for (std::uint64_t seed = 50; seed < 56; ++seed) {
    const auto white = made::white(kCount, seed);
    EXPECT_TRUE(proposed_by("tone", answer_with_noise(white)).empty()) << seed;
    EXPECT_TRUE(
        proposed_by("tone", answer_with_noise(made::answer({1.0}, {1.0, -0.95}, white))).empty())
        << seed;
  }
}

TEST(EffectsOfTimeTest, ADriftInItsForms) {
  expect_proposed(
      planted("drift", "linear", answer_and([](double t_s) { return 0.3 * (t_s / kLength_s); })));
  expect_proposed(planted("drift", "slow cosines", answer_and([](double t_s) {
                            return 0.2 * std::cos(2.0 * std::numbers::pi * t_s / kLength_s);
                          })));
  // 0.1, 0.25 and 0.5 of the record are tried: 6, 15 and 30 s.
  expect_proposed(planted("drift", "exponential",
                          answer_and([](double t_s) { return 0.5 * std::exp(-t_s / 9.0); })),
                  {{0, 9.0, 6.1, 1.0}});
}

TEST(EffectsOfTimeTest, WhiteNoiseIsNoDrift) {
  for (std::uint64_t seed = 60; seed < 70; ++seed) {
    EXPECT_TRUE(proposed_by("drift", answer_with_noise(made::white(kCount, seed))).empty()) << seed;
  }
}

TEST(EffectsOfTimeTest, AGainThatChangesSlowly) {
  expect_proposed(planted("time_varying_gain", "linear", answer_times([](double t_s) {
                            return 1.0 + 0.2 * (2.0 * t_s / kLength_s - 1.0);
                          })),
                  {{0, 0.2, 0.02, 0.004}});
  Planted wave = planted("time_varying_gain", "sinusoidal", answer_times([](double t_s) {
                           return 1.0 + 0.2 * std::sin(kTwoPi * 2.8 * t_s / kLength_s);
                         }));
  // 2 and 3 cycles are tried; 3 instead of 2.8 turn the phase by 0.2 pi in the middle of the
  // record, and 0.2 sin(0.2 pi) = 0.118.
  expect_proposed(wave, {{0, 2.8, 0.21, 0.02}, {1, 0.2, 0.06, 0.005}, {2, 0.0, 0.12, 0.005}});
  Planted bend = planted("time_varying_gain", "slow cosines", answer_times([](double t_s) {
                           return 1.0 + 0.15 * std::cos(std::numbers::pi * t_s / kLength_s) -
                                  0.1 * std::cos(3.0 * std::numbers::pi * t_s / kLength_s);
                         }));
  expect_proposed(bend, {{0, 0.15, 0.02, 0.004}, {1, 0.0, 0.02, 0.004}, {2, -0.1, 0.02, 0.004}});
}

// A fortieth of the record, then a twentieth of that: 1.35 s, then 0.07 s.
TEST(EffectsOfTimeTest, AGainThatChangesAtOnce) {
  Planted sut = planted("regime_change", "step of the gain",
                        answer_times([](double t_s) { return t_s < 22.4 ? 0.85 : 1.15; }));
  // The moment isn't fitted further: 0.2 s off at most, of 60, with 0.3 of the output's RMS.
  sut.left = 3.0;
  expect_proposed(sut, {{0, 22.4, 0.2, 0.2}, {1, 0.15, 0.02, 0.006}});
}

TEST(EffectsOfTimeTest, IsolatedBursts) {
  const auto shape = [](double t_s, double begin_s) {
    const double since_s = t_s - begin_s;
    return since_s > 0.0 && since_s < 0.3 ? std::sin(kTwoPi * 10.0 * since_s) : 0.0;
  };
  // Windows of 0.2 s, half over each other, and 0.15 s on both sides.
  expect_proposed(planted("transients", "isolated bursts", answer_and([&](double t_s) {
                            return shape(t_s, 17.3) + shape(t_s, 42.1);
                          })),
                  {{0, 17.15, 0.21, 0.21},
                   {1, 17.75, 0.21, 0.21},
                   {2, 41.95, 0.21, 0.21},
                   {3, 42.55, 0.21, 0.21}});
}

// Noise whose power changes by a factor of nine, and noise with heavy tails: no burst.
TEST(EffectsOfTimeTest, NoiseIsNoBurst) {
  for (std::uint64_t seed = 80; seed < 86; ++seed) {
    std::vector<double> noise = made::white(kCount, seed);
    EXPECT_TRUE(proposed_by("transients", answer_with_noise(noise)).empty()) << seed;
    std::vector<double> uneven = noise;
    std::vector<double> heavy = noise;
    signal::Gaussian draw(seed, 1);
    for (std::size_t n = 0; n < kCount; ++n) {
      uneven[n] *= 2.0 + std::sin(kTwoPi * static_cast<double>(n) / 1500.0);
      if (draw.uniform() < 0.01) heavy[n] *= 8.0;
    }
    EXPECT_TRUE(proposed_by("transients", answer_with_noise(uneven)).empty()) << seed;
    EXPECT_TRUE(proposed_by("transients", answer_with_noise(heavy)).empty()) << seed;
  }
}

}  // namespace stillhand::diagnosis::effects_of_time_test

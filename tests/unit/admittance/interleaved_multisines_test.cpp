// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/interleaved_multisines.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "services/core/contract/config_error.hpp"

namespace stillhand::admittance::interleaved_multisines_test {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

struct Peaks {
  double accel, position;
};

// Sixteen times finer than the samples, by a sum of sines of this test.
Peaks fine_peaks(const signal::Multisine& sine, double period_s) {
  Peaks out{0.0, 0.0};
  const std::int64_t count = 16 * sine.samples_per_period();
  for (std::int64_t n = 0; n < count; ++n) {
    double accel = 0.0;
    double position = 0.0;
    for (const signal::Component& c : sine.components()) {
      const double w = 2.0 * std::numbers::pi * static_cast<double>(c.harmonic) / period_s;
      const double t_s = period_s * static_cast<double>(n) / static_cast<double>(count);
      accel += c.amplitude_m_s2 * std::sin(w * t_s + c.phase_rad);
      position -= c.amplitude_m_s2 / (w * w) * std::sin(w * t_s + c.phase_rad);
    }
    out.accel = std::max(out.accel, std::abs(accel));
    out.position = std::max(out.position, std::abs(position));
  }
  return out;
}

// Eq. AD-1.
TEST(InterleavedMultisinesTest, LinesAreOddRiseInTurnAndSpanTheBand) {
  const Excitation sut = design({});
  std::vector<std::int64_t> all;
  for (const auto& c : sut.force.components()) all.push_back(c.harmonic);
  for (const auto& c : sut.motion.components()) all.push_back(c.harmonic);
  EXPECT_EQ(all.size(), 40u);
  EXPECT_EQ(std::set<std::int64_t>(all.begin(), all.end()).size(), 40u);
  for (const std::int64_t k : all) EXPECT_EQ(k % 2, 1) << k;
  EXPECT_EQ(sut.force.components().front().harmonic, 1);    // 0.05 Hz
  EXPECT_EQ(sut.motion.components().back().harmonic, 399);  // 19.95 Hz
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_LT(sut.force.components()[i].harmonic, sut.motion.components()[i].harmonic);
    if (i == 0) continue;
    EXPECT_LT(sut.motion.components()[i - 1].harmonic, sut.force.components()[i].harmonic);
  }
  // 1, 2.52, 6.35 and 16 cycles: odd, not above, and 2 apart.
  const ExcitationConfig few{.period_s = 10.0, .lowest_hz = 0.1, .highest_hz = 1.6, .lines = 2};
  EXPECT_EQ(interleaved_harmonics(few), (std::vector<std::int64_t>{1, 3, 5, 15}));
}

// Eq. AD-3, at a rate at which the peaks between the samples matter.
TEST(InterleavedMultisinesTest, BoundsHoldBetweenTheSamples) {
  for (const std::int64_t seed : {1, 2, 3}) {
    for (const bool schroeder : {false, true}) {
      const ExcitationConfig config{.rate_hz = 60.0, .schroeder = schroeder, .seed = seed};
      const Excitation sut = design(config);
      const Peaks force = fine_peaks(sut.force, config.period_s);
      const Peaks motion = fine_peaks(sut.motion, config.period_s);
      EXPECT_LE(force.accel, config.peak_force_n);
      // cos(pi n/N) = 0.5 at 20 Hz of 60 Hz: the bound is used to the half at least.
      EXPECT_GE(force.accel, 0.5 * config.peak_force_n);
      EXPECT_LE(motion.accel, config.peak_acceleration_m_s2);
      EXPECT_LE(motion.position, config.peak_position_m);
    }
  }
}

TEST(InterleavedMultisinesTest, TheBoundOfThePositionScalesTheMotion) {
  const ExcitationConfig config{.rate_hz = 250.0, .peak_position_m = 0.001};
  const Excitation sut = design(config);
  const Peaks motion = fine_peaks(sut.motion, config.period_s);
  EXPECT_LE(motion.position, 0.001);
  EXPECT_GE(motion.position, 0.95 * 0.001);  // cos(pi 399/5000) = 0.969
  EXPECT_LT(motion.accel, config.peak_acceleration_m_s2);
}

// Eq. AD-2.
TEST(InterleavedMultisinesTest, AmplitudesFollowTheShape) {
  ExcitationConfig config;
  config.force = {.low_corner_hz = 0.5, .low_slope = 1.0, .high_corner_hz = 5.0, .high_slope = 2.0};
  const Excitation sut = design(config);
  const auto& lines = sut.force.components();
  const double flat = lines[10].amplitude_m_s2;  // between the corners
  for (const auto& c : lines) {
    const double f_hz = static_cast<double>(c.harmonic) / config.period_s;
    const double want = f_hz < 0.5 ? f_hz / 0.5 : f_hz > 5.0 ? 25.0 / (f_hz * f_hz) : 1.0;
    EXPECT_NEAR(c.amplitude_m_s2 / flat, want, 1e-12) << f_hz;
  }
  // The default of the platform below 0.5 Hz: the same displacement, so that A goes with f^2.
  const auto& slow = sut.motion.components();
  ASSERT_LT(slow[1].harmonic, 10);
  const auto ratio = static_cast<double>(slow[1].harmonic) / static_cast<double>(slow[0].harmonic);
  EXPECT_NEAR(slow[1].amplitude_m_s2 / slow[0].amplitude_m_s2, ratio * ratio, 1e-12);
}

TEST(InterleavedMultisinesTest, TheSeedGivesThePhases) {
  const auto phase = [](std::int64_t seed) {
    return design({.seed = seed}).force.components()[3].phase_rad;
  };
  EXPECT_EQ(phase(5), phase(5));
  EXPECT_NE(phase(5), phase(6));
}

TEST(InterleavedMultisinesTest, RefusesWhatCannotBe) {
  EXPECT_THAT([] { design({.lines = 150}); },
              ThrowsMessage<ConfigError>(HasSubstr("excitation.lines: got 150")));
  EXPECT_THAT([] { design({.lowest_hz = 0.01}); },
              ThrowsMessage<ConfigError>(HasSubstr("at least one cycle in period_s")));
  EXPECT_THAT([] { design({.rate_hz = 50.0}); },
              ThrowsMessage<ConfigError>(HasSubstr("excitation.highest_hz")));
  EXPECT_THAT([] { design({.peak_force_n = 26.0}); },
              ThrowsMessage<ConfigError>(HasSubstr("excitation.peak_force_n: got 26")));
  EXPECT_THAT([] { design({.period_s = 20.00001}); },
              ThrowsMessage<ConfigError>(HasSubstr("a whole number of samples")));
}

}  // namespace
}  // namespace stillhand::admittance::interleaved_multisines_test

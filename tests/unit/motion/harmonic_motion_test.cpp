// SPDX-License-Identifier: Apache-2.0
#include "services/core/motion/harmonic_motion.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "services/core/signal/multisine.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::motion::harmonic_motion_test {

constexpr Tick kPeriod = 20'000;

// Random phases and amplitudes on harmonics 14 to 80 of 20 s: 0.7 to 4 Hz.
std::vector<signal::Component> components() {
  signal::Gaussian random(4, 0);
  std::vector<signal::Component> out;
  for (std::int64_t k = 14; k <= 80; ++k) {
    out.push_back({k, 0.1 + random.uniform(), 6.28 * random.uniform()});
  }
  return out;
}

MotionSpectrum spectrum_of(const std::vector<signal::Component>& components, Tick period) {
  MotionSpectrum spectrum;
  spectrum.period_s = static_cast<double>(period) * kControlPeriod_s;
  spectrum.first = components.front().harmonic;
  for (const auto& c : components) {
    spectrum.accel_m_s2.push_back(std::polar(c.amplitude_m_s2, c.phase_rad) *
                                  std::complex<double>{0.0, -1.0});
  }
  return spectrum;
}

// Oracle: the sum of sines itself, Eq. SG-1.  MO-9 states 1e-9 of the acceleration and 2e-12 of the
// position for a component at the band's edge; 67 components of at most 1.1 m/s^2 each, position
// at most 1.1/(2 pi 0.7)^2 = 0.057 m each.
// Also over a prime number of ticks, where a transform of that length would be slow.
TEST(HarmonicMotionTest, ItIsTheSumOfItsHarmonics) {
  for (const Tick period : {kPeriod, Tick{19'997}}) {
    const signal::Multisine oracle(period, kControlRateHz, components());
    const HarmonicMotion sut(spectrum_of(components(), period));
    for (Tick n = 0; n < period; n += 3) {
      const auto got = sut.at(n);
      const auto want = oracle.at(n);
      ASSERT_NEAR(got.accel_m_s2, want.accel_m_s2, 67 * 1.1 * 1e-9) << n;
      ASSERT_NEAR(got.vel_m_s, want.vel_m_s, 67 * 0.25 * 1e-10) << n;
      ASSERT_NEAR(got.pos_m, want.pos_m, 67 * 0.057 * 2e-12) << n;
    }
  }
}

TEST(HarmonicMotionTest, ItContinuesPeriodicallyOnBothSides) {
  const HarmonicMotion sut(spectrum_of(components(), kPeriod));
  for (Tick n = -500; n < 0; ++n) {
    // The place within the period carries the rounding of n/h: 1e-12 of a cell, times jerk and
    // cell.
    ASSERT_NEAR(sut.at(n).accel_m_s2, sut.at(n + kPeriod).accel_m_s2, 1e-8);
    ASSERT_NEAR(sut.at(n + 5 * kPeriod).pos_m, sut.at(n + kPeriod).pos_m, 1e-12);
  }
}

TEST(HarmonicMotionTest, TheGridHasOnlySmallFactorsAndEnoughPoints) {
  for (std::int64_t k = 3; k < 2000; k += 17) {
    const MotionSpectrum spectrum{.period_s = 10.0, .first = k, .accel_m_s2 = {{1.0, 0.0}}};
    std::size_t size = grid_size(spectrum);
    EXPECT_GE(size, static_cast<std::size_t>(25 * k));
    EXPECT_LE(size, static_cast<std::size_t>(30 * k));
    for (const std::size_t factor : {2u, 3u, 5u}) {
      while (size % factor == 0) size /= factor;
    }
    EXPECT_EQ(size, 1u);
  }
}

}  // namespace stillhand::motion::harmonic_motion_test

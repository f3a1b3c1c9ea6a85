// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/growing_oscillation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <vector>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::signal::growing_oscillation_test {
namespace {

struct Found {
  Tick at = -1;     ///< of the finding, -1: none
  Tick onset = -1;  ///< first tick at which the amplitude has reached the bound
  double frequency_hz = 0.0;
};

// A sine whose amplitude grows by `growth` each half wave from 1 mrad to 0.5 rad, with sensor noise
// and the encoder's steps; the amplitude stays at 0.5 rad for two seconds.
Found run(double frequency_hz, double growth, double bound_rad, std::uint64_t seed) {
  constexpr double kStep_rad = kTwoPi / 4096.0;
  GrowingOscillation sut{OscillationLimits{}};
  Gaussian normal(seed, 0);
  const double phase = kTwoPi * normal.uniform();
  Found found;
  double amplitude = 0.001;
  Tick left = 2000;
  for (Tick n = 0; left > 0; ++n) {
    const double t = static_cast<double>(n) * kControlPeriod_s;
    amplitude = std::min(0.001 * std::pow(growth, 2.0 * frequency_hz * t), 0.5);
    if (amplitude >= 0.5) --left;
    if (found.onset < 0 && amplitude >= bound_rad) found.onset = n;
    const double theta =
        amplitude * std::sin(kTwoPi * frequency_hz * t + phase) + 0.0003 * normal();
    if (sut.step(std::round(theta / kStep_rad) * kStep_rad) && found.at < 0) {
      found.at = n;
      found.frequency_hz = sut.frequency_hz();
    }
  }
  return found;
}

// The property of the issue: a growing oscillation is found within two periods of the amplitude at
// which it counts.  1.1 a half wave is a damping ratio of -0.03.
TEST(GrowingOscillationTest, AGrowingOscillationIsFoundWithinTwoPeriods) {
  for (const double f : {0.8, 1.2, 2.0, 3.0, 4.5, 6.5, 9.0}) {
    for (const double growth : {1.1, 1.2, 1.5, 2.0, 3.0}) {
      for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        const Found found = run(f, growth, OscillationLimits{}.floor_rad, seed);
        ASSERT_GE(found.at, 0) << f << " Hz, " << growth;
        EXPECT_LE(static_cast<double>(found.at - found.onset), 2.0 * kControlRateHz / f)
            << f << " Hz, " << growth << ", seed " << seed;
        EXPECT_NEAR(found.frequency_hz / f, 1.0, 0.2) << growth;
      }
    }
  }
}

// One that grows too slowly to stand out from noise is found at the ceiling.  At the edges of the
// band the filter takes 2 % of the amplitude, which is one half wave of such growth.
TEST(GrowingOscillationTest, ASlowlyGrowingOscillationIsFoundWithinTwoPeriodsOfTheCeiling) {
  for (const double f : {0.8, 2.0, 4.5, 9.0}) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      const Found found = run(f, 1.02, OscillationLimits{}.ceiling_rad / 0.98, seed);
      ASSERT_GE(found.at, 0) << f << " Hz";
      EXPECT_LE(static_cast<double>(found.at - found.onset), 2.0 * kControlRateHz / f) << f;
    }
  }
}

TEST(GrowingOscillationTest, ADyingOrASmallOscillationIsNone) {
  for (const double f : {0.8, 2.0, 4.5, 9.0}) {
    GrowingOscillation dying{OscillationLimits{}};
    GrowingOscillation small{OscillationLimits{}};
    for (Tick n = 0; n < 20'000; ++n) {
      const double t = static_cast<double>(n) * kControlPeriod_s;
      const double s = std::sin(kTwoPi * f * t);
      dying.step(0.2 * std::pow(0.6, 2.0 * f * t) * s);  // two half waves above the ceiling
      small.step(0.8 * OscillationLimits{}.floor_rad * s);
    }
    EXPECT_FALSE(small.found()) << f;
    EXPECT_FALSE(dying.found()) << f;
  }
}

struct Wave {
  double floors;  // amplitude
  Tick ticks = 62;
};

// Half waves after eight of 0.3 floors, and three of those behind them.  The band-pass changes an
// amplitude next to a larger jump by up to 0.24 floors and a length by up to 5 ticks; no half wave
// of the cases passes a bound by that.
// @return the tick of the finding, -1: none
Tick found_in(GrowingOscillation& sut, std::vector<Wave> waves) {
  waves.insert(waves.begin(), 8, Wave{0.3});
  waves.insert(waves.end(), 3, Wave{0.3});
  double side = OscillationLimits{}.floor_rad;
  Tick tick = 0;
  for (const Wave& wave : waves) {
    side = -side;
    for (Tick n = 0; n < wave.ticks; ++n, ++tick) {
      const double turns = 0.5 * static_cast<double>(n) / static_cast<double>(wave.ticks);
      if (sut.step(side * wave.floors * std::sin(kTwoPi * turns))) return tick;
    }
  }
  return -1;
}

// Eqs. VH-7 and VH-8 word by word, with a growth of 1.2 and a ceiling of two floors.
TEST(GrowingOscillationTest, EveryConditionIsNeeded) {
  const struct {
    const char* what;
    std::vector<Wave> waves;
    bool found;
  } cases[] = {
      {"grows three times", {{0.8}, {1.1}, {1.6}}, true},
      {"the newest does not grow", {{0.45}, {0.65}, {0.95}, {1.05}}, false},
      {"the one before does not", {{0.8}, {1.1}, {1.05}, {1.5}}, false},
      {"the third does not", {{1.0}, {0.9}, {1.3}, {1.8}}, false},
      {"lengths 80 over 62", {{0.8}, {1.1, 80}, {1.6}}, true},
      {"lengths 110 over 62: not regular", {{0.8}, {1.1, 110}, {1.6}}, false},
      {"12.5 Hz: above the band", {{0.8, 40}, {1.1, 40}, {1.6, 40}, {1.9, 40}}, false},
      {"three above the ceiling", {{2.4}, {2.4}, {2.4}}, true},
      {"two above the ceiling", {{2.4}, {2.4}}, false},
      {"one between below the ceiling", {{2.4}, {1.2}, {2.4}}, false},
  };
  for (const auto& [what, waves, found] : cases) {
    GrowingOscillation sut{OscillationLimits{.growth = 1.2}};
    const Tick first = found_in(sut, waves);
    EXPECT_EQ(first >= 0, found) << what;
    sut.reset();
    EXPECT_EQ(sut.frequency_hz() + sut.amplitude_rad() + sut.last_amplitude_rad(), 0.0);
    EXPECT_EQ(found_in(sut, waves), first) << what << ", again";
  }
}

// A person's steering: slow, as large as the stick allows.
TEST(GrowingOscillationTest, SteeringBelowTheBandIsNone) {
  GrowingOscillation sut{OscillationLimits{}};
  for (Tick n = 0; n < 120'000; ++n) {
    const double t = static_cast<double>(n) * kControlPeriod_s;
    sut.step(0.4 * std::sin(kTwoPi * 0.3 * t) * std::min(t / 20.0, 1.0));
  }
  EXPECT_FALSE(sut.found());
}

TEST(GrowingOscillationTest, NothingThatAStickReportsBreaksIt) {
  Gaussian normal(5, 0);
  GrowingOscillation sut{OscillationLimits{}};
  for (int n = 0; n < 200'000; ++n) {
    double theta = 1e3 * normal();
    if (n % 7 == 0) theta = std::numeric_limits<double>::quiet_NaN();
    if (n % 11 == 0) theta = std::numeric_limits<double>::infinity();
    if (n % 13 == 0) theta = 1e308;
    sut.step(theta);
    ASSERT_TRUE(std::isfinite(sut.amplitude_rad()));
  }
  sut.reset();
  EXPECT_FALSE(sut.found());
  for (int n = 0; n < 5000; ++n) ASSERT_FALSE(sut.step(0.2));  // a stick at rest off the middle
}

// False alarms a minute of a stable, noise-driven loop: a resonance of damping z driven by white
// noise, its RMS a share of the floor.  METHOD, "False alarms", has the table; 20 minutes of each.
// Bounds: four half waves that each grow by 1.05 are one in some hundred half waves of such noise;
// what decides is the floor, which a Gaussian of RMS floor/4 reaches with exp(-8) a half wave.
TEST(GrowingOscillationTest, FalseAlarmsOfAStableLoopAreRare) {
  const OscillationLimits limits;
  const auto alarms = [&](double damping, double rms_rad) {
    Gaussian normal(11, static_cast<std::uint64_t>(1000.0 * damping));
    SecondOrderLag loop(kTwoPi * 2.5, damping, kControlPeriod_s);
    // RMS of the lag under white noise: sigma^2 w dt / (4 z).
    const double sigma = rms_rad / std::sqrt(kTwoPi * 2.5 * kControlPeriod_s / (4.0 * damping));
    GrowingOscillation sut{limits};
    int count = 0;
    for (Tick n = 0; n < 1'200'000; ++n) {
      if (!sut.step(loop.step(sigma * normal()).x)) continue;
      ++count;
      sut.reset();
    }
    return count / 20.0;
  };
  for (const double damping : {0.02, 0.05, 0.1, 0.3}) {
    const double quarter = alarms(damping, limits.floor_rad / 4.0);
    const double third = alarms(damping, limits.floor_rad / 3.0);
    const double half = alarms(damping, limits.floor_rad / 2.0);
    std::printf(
        "damping %.2f: %.2f, %.2f, %.2f false alarms a minute at an RMS of 1/4, 1/3, 1/2 "
        "of the floor\n",
        damping, quarter, third, half);
    EXPECT_LE(quarter, 0.2);
    EXPECT_LE(third, 3.0);
  }
}

TEST(GrowingOscillationTest, AFloorAboveTheCeilingIsRefused) {
  const OscillationLimits limits{.floor_rad = 0.2};
  EXPECT_THROW(GrowingOscillation{limits}, ConfigError);
}

}  // namespace
}  // namespace stillhand::signal::growing_oscillation_test

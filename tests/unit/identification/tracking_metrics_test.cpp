// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/tracking_metrics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/units.hpp"
#include "services/core/signal/random.hpp"
#include "services/core/signal/spectrum.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::identification::tracking_metrics_test {
namespace {

using Complex = std::complex<double>;

// A record whose lines obey x_p = wc/(jw) e^(-jw Td) x_e exactly, every line by itself.
TrackingRecord crossover_model(double crossover_hz, double delay_s, double duration_s,
                               double rate_hz) {
  const auto design = signal::reference_design(duration_s);
  const auto count = static_cast<std::size_t>(duration_s * rate_hz);
  TrackingRecord record{rate_hz, std::vector<double>(count), std::vector<double>(count)};
  for (std::size_t k = 0; k < signal::kReferenceLines; ++k) {
    const double f = static_cast<double>(design.harmonics[k]) / duration_s;
    const Complex gain = crossover_hz / f * std::polar(1.0, -kTwoPi * f * delay_s) / Complex(0, 1);
    const Complex target = std::polar(0.02 * design.amplitudes[k], 0.7 * static_cast<double>(k));
    const Complex cursor = target * gain / (1.0 + gain);
    for (std::size_t n = 0; n < count; ++n) {
      const auto cycles = static_cast<std::size_t>(design.harmonics[k]) * n % count;
      const Complex turn =
          std::polar(1.0, kTwoPi * static_cast<double>(cycles) / static_cast<double>(count));
      record.target_m[n] += (target * turn).real();
      record.cursor_m[n] += (cursor * turn).real();
    }
  }
  return record;
}

TEST(TrackingMetricsTest, FindsTheCrossoverOfTheCrossoverModel) {
  for (const double duration_s : {20.0, 60.0, 180.0}) {
    for (const double crossover_hz : {0.1, 0.25, 0.4}) {
      const auto record = crossover_model(crossover_hz, 0.15, duration_s, 100.0);
      const auto sut = tracking_metrics(record, signal::reference_design(duration_s));
      // Lines are exact to 1e-14 of the largest sample, the smallest line above 1e-3 of it: 1e-11.
      EXPECT_NEAR(sut.crossover_hz, crossover_hz, 1e-10);
      // Rounding is the only remnant; the loop is exactly of the fitted slope.
      EXPECT_NEAR(sut.crossover_reference_hz, crossover_hz, 1e-10);
    }
  }
}

TEST(TrackingMetricsTest, LinesCarryGainAndPhase) {
  const auto sut =
      tracking_metrics(crossover_model(0.25, 0.2, 60.0, 100.0), signal::reference_design(60.0));
  for (const auto& line : sut.lines) {
    const Complex expected = 0.25 / line.frequency_hz *
                             std::polar(1.0, -kTwoPi * line.frequency_hz * 0.2) / Complex(0, 1);
    EXPECT_LT(std::abs(line.gain - expected), 1e-9 * std::abs(expected)) << line.frequency_hz;
  }
}

TEST(TrackingMetricsTest, RateOfTheRecordMakesNoDifference) {
  const auto slow =
      tracking_metrics(crossover_model(0.2, 0.15, 20.0, 100.0), signal::reference_design(20.0));
  const auto fast =
      tracking_metrics(crossover_model(0.2, 0.15, 20.0, 1000.0), signal::reference_design(20.0));
  EXPECT_NEAR(fast.crossover_hz, slow.crossover_hz, 1e-10);
}

// Closed loop in time with remnant: x_p(n+1) = x_p(n) + 2 pi fc dt (x_e(n - D) + remnant).
struct Loop {
  double crossover_hz = 0.25;
  std::size_t delay = 15;  // [samples at 100 Hz]
  double remnant_m = 0.0;
};
TrackingRecord run(const Loop& loop, const signal::ReferenceDesign& design, std::uint64_t seed) {
  const signal::ReferenceSignal target(design, 6000, seed, 0.02);
  signal::Gaussian noise(seed, 77);
  TrackingRecord record{100.0, {}, {}};
  std::vector<double> error(loop.delay + 1, 0.0);
  double x_p = 0.0;
  for (Tick n = -12'000; n < 6000; ++n) {  // two periods to settle
    error[static_cast<std::size_t>(n + 12'000) % error.size()] = target.at(n) - x_p;
    if (n >= 0) {
      record.target_m.push_back(target.at(n));
      record.cursor_m.push_back(x_p);
    }
    const double seen = error[static_cast<std::size_t>(n + 12'001) % error.size()];
    x_p += kTwoPi * loop.crossover_hz * 0.01 * (seen + loop.remnant_m * noise());
  }
  return record;
}
// The same fit on the loop's own gain: |G| = 2 pi fc dt / |2 sin(w dt / 2)|.
double true_crossover(const Loop& loop, const signal::ReferenceDesign& design) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 11; ++k) {
    const double f = static_cast<double>(design.harmonics[k]) / 60.0;
    const double gain =
        std::numbers::pi * loop.crossover_hz * 0.01 / std::sin(std::numbers::pi * f * 0.01);
    sum += std::log10(gain) + std::log10(f);
  }
  return std::pow(10.0, sum / 11.0);
}

TEST(TrackingMetricsTest, FindsTheCrossoverOfALoopInTime) {
  const auto design = signal::reference_design(60.0);
  const Loop loop;
  const auto sut = tracking_metrics(run(loop, design, 1), design);
  // Settled to (1 - 2 pi 0.25 / 100)^12000 = e^-188; lines exact.
  EXPECT_NEAR(sut.crossover_hz, true_crossover(loop, design), 1e-9);
}

TEST(TrackingMetricsTest, TakingTheRemnantOffLessensItsBias) {
  // Remnant as large as the signal at the outer lines: |X_p| and |X_e| there tend to each other,
  // and the mean of logarithms comes out low.  Spread of one trial about 0.04 Hz with either
  // estimate (measured), so 0.004 Hz for the mean of 100: what is asserted is three of them apart.
  const auto design = signal::reference_design(60.0);
  const Loop loop{.remnant_m = 0.08};
  const double truth = true_crossover(loop, design);
  double paper = 0.0;
  double reference = 0.0;
  constexpr int kTrials = 100;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    const auto sut = tracking_metrics(run(loop, design, seed), design);
    paper += sut.crossover_hz / kTrials;
    reference += sut.crossover_reference_hz / kTrials;
  }
  std::printf("crossover: true %.4f Hz, paper %.4f, through the reference %.4f\n", truth, paper,
              reference);
  EXPECT_LT(paper, truth - 0.012);
  EXPECT_NEAR(reference, truth, 0.012);
}

TEST(TrackingMetricsTest, GainAtALineIsAlsoTheEstimateThroughTheReference) {
  // conj(X_r) X_p / conj(X_r) X_e: one record, whole cycles, one number.
  const auto design = signal::reference_design(60.0);
  const Loop loop{.remnant_m = 0.05};
  const auto record = run(loop, design, 3);
  const auto sut = tracking_metrics(record, design);
  std::vector<double> error(record.target_m.size());
  for (std::size_t n = 0; n < error.size(); ++n) error[n] = record.target_m[n] - record.cursor_m[n];
  for (const auto& line : sut.lines) {
    const Complex x_r = std::conj(signal::line_at(record.target_m, line.harmonic));
    const Complex expected = x_r * signal::line_at(record.cursor_m, line.harmonic) /
                             (x_r * signal::line_at(error, line.harmonic));
    EXPECT_LT(std::abs(line.gain - expected), 1e-9 * std::abs(expected)) << line.harmonic;
  }
}

TEST(TrackingMetricsTest, SignalToRemnantIsOneWithoutSignal) {
  // No target at all: the loop follows its own noise, lines are like their neighbours.  Ratio of
  // one exponential power to the mean of six: expectation 6/5, so over 15 lines and 40 trials 1.2
  // with a standard deviation of 1.3/sqrt(600) = 0.06 (neighbours shared, so at most twice that).
  const auto design = signal::reference_design(60.0);
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    TrackingRecord record{100.0, std::vector<double>(6000, 0.0), std::vector<double>(6000)};
    signal::Gaussian noise(seed, 5);
    for (double& x : record.cursor_m) x = 0.001 * noise();
    const auto sut = tracking_metrics(record, design);
    for (const auto& line : sut.lines) mean += line.cursor_snr / 600.0;
  }
  EXPECT_NEAR(mean, 1.2, 0.36);
}

// Error of a known shape; the target carries it, the cursor rests.
TrackingRecord with_error(const std::vector<double>& error_m) {
  return {100.0, error_m, std::vector<double>(error_m.size(), 0.0)};
}

TEST(TrackingMetricsTest, DwellAndRmsOfASawtoothAreKnown) {
  // Even steps from -30 to +30 mm: half of them within 15 mm, RMS 30/sqrt(3) mm.
  std::vector<double> error;
  for (int n = 0; n < 6000; ++n) error.push_back(-0.03 + 0.06 * ((n % 600) + 0.5) / 600.0);
  const auto sut = tracking_metrics(with_error(error), signal::reference_design(60.0));
  EXPECT_EQ(sut.dwell_ratio, 0.5);
  // Midpoint rule: relative error 1/(2 * 600^2).
  EXPECT_NEAR(sut.rms_error_mm, 30.0 / std::sqrt(3.0), 30.0 / (2.0 * 600.0 * 600.0));
}

TEST(TrackingMetricsTest, DwellOfASineIsItsArcsine) {
  std::vector<double> error;
  for (int n = 0; n < 6000; ++n) error.push_back(0.04 * std::sin(kTwoPi * 7.0 * n / 6000.0));
  const auto sut = tracking_metrics(with_error(error), signal::reference_design(60.0));
  // 28 crossings of the edge, each placed to within a sample.
  EXPECT_NEAR(sut.dwell_ratio, 2.0 / std::numbers::pi * std::asin(15.0 / 40.0), 28.0 / 6000.0);
  EXPECT_NEAR(sut.rms_error_mm, 40.0 / std::numbers::sqrt2, 1e-9);
}

TEST(TrackingMetricsTest, ExactlyOnTheEdgeIsOutside) {
  const auto sut = tracking_metrics(with_error(std::vector<double>(6000, 0.015)),
                                    signal::reference_design(60.0));
  EXPECT_EQ(sut.dwell_ratio, 0.0);
  // A cursor and an error without any line have no crossover.
  EXPECT_TRUE(std::isnan(sut.crossover_hz));
  EXPECT_TRUE(std::isnan(sut.crossover_reference_hz));
}

TEST(TrackingMetricsTest, MovingWindowsFollowAChange) {
  std::vector<double> error(6000, 0.010);
  for (std::size_t n = 3000; n < 6000; ++n) error[n] = 0.020;
  const auto sut = tracking_metrics(with_error(error), signal::reference_design(60.0));
  ASSERT_EQ(sut.moving_rms_mm.size(), 5001u);
  ASSERT_EQ(sut.moving_dwell.size(), 5001u);
  EXPECT_NEAR(sut.moving_rms_mm[2000], 10.0, 1e-9);
  EXPECT_NEAR(sut.moving_dwell[2500], 0.5, 1e-12);  // 500 of 1000 samples before the change
  EXPECT_NEAR(sut.moving_rms_mm[2500], std::sqrt(250.0), 1e-9);
  EXPECT_NEAR(sut.moving_rms_mm[3000], 20.0, 1e-9);
  EXPECT_EQ(sut.moving_dwell[3000], 0.0);
}

TEST(TrackingMetricsTest, UnusableRecordsAreRefused) {
  const auto design = signal::reference_design(60.0);
  auto record = crossover_model(0.2, 0.1, 60.0, 100.0);
  auto broken = record;
  broken.cursor_m[5] = std::nan("");
  EXPECT_THROW(tracking_metrics(broken, design), ConfigError);
  broken = record;
  broken.cursor_m.pop_back();
  EXPECT_THROW(tracking_metrics(broken, design), ConfigError);
  EXPECT_THROW(tracking_metrics({100.0, {1.0}, {1.0}}, design), ConfigError);
  // The highest line is 240, and its neighbours reach to 246.
  for (const std::size_t samples : {492u, 493u}) {
    const std::vector<double> still(samples, 0.0);
    const auto metrics = [&] { tracking_metrics({100.0, still, still}, design); };
    EXPECT_EQ(
        support::refusal(metrics),
        samples == 492 ? "tracking.target_m: got 492 samples, want more than 492" : "accepted");
  }
}

}  // namespace
}  // namespace stillhand::identification::tracking_metrics_test

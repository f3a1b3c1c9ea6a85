// SPDX-License-Identifier: Apache-2.0
// Another host's clock from two-way exchanges, Eq. CK-1 to CK-5: against clocks that are known.
#include "services/core/clock/clock_comparison.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "services/core/signal/random.hpp"

namespace stillhand::clock::clock_comparison_test {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;
constexpr std::int64_t kEvery_ns = kSecond_ns / 4;

// Two hosts and the network between them; the other's clock is days ahead, as boots are.
struct Network {
  double drift = 0.0;  ///< [s/s]
  std::int64_t offset_ns = 300'000 * kSecond_ns;
  double way_us = 80.0;
  double jitter_us = 30.0;  ///< exponential, each way
  double held_up = 0.0;     ///< share of messages that wait up to 20 ms more
  std::int64_t now_ns = 7'000 * kSecond_ns;
  signal::Gaussian draw{1, 1};

  std::int64_t other(std::int64_t own_ns) const {
    return own_ns + offset_ns +
           std::llround(drift * static_cast<double>(own_ns - 7'000 * kSecond_ns));
  }
  double uniform() { return 0.5 * std::erfc(draw() / std::sqrt(2.0)); }
  std::int64_t way_ns() {
    double us = way_us - jitter_us * std::log(uniform());
    if (uniform() < held_up) us += 20'000.0 * uniform();
    return std::llround(1e3 * us);
  }
  Exchange exchange() {
    now_ns += kEvery_ns;
    const std::int64_t there_ns = now_ns + way_ns();
    const std::int64_t answered_ns = there_ns + 20'000;
    const std::int64_t back_ns = answered_ns + way_ns();
    return {now_ns, other(there_ns), other(answered_ns), back_ns};
  }
};

void run(ClockComparison& sut, Network& network, int exchanges) {
  for (int i = 0; i < exchanges; ++i) sut.take(network.exchange());
}

// Without jitter: number i of those that are asked every quarter of a second.
Exchange even(int i, std::int64_t ahead_ns, std::int64_t way_ns = 80'000) {
  const std::int64_t asked_ns = 1000 * kSecond_ns + i * kEvery_ns;
  const std::int64_t there_ns = asked_ns + way_ns;
  return {asked_ns, there_ns + ahead_ns, there_ns + 20'000 + ahead_ns, there_ns + 20'000 + way_ns};
}

double error_ns(const ClockComparison& sut, const Network& network) {
  return static_cast<double>(sut.offset(network.now_ns)->offset_ns -
                             (network.other(network.now_ns) - network.now_ns));
}

TEST(ClockComparisonTest, SaysNothingBeforeEightExchanges) {
  ClockComparison sut;
  for (const int i : {0, 1, 2, 3, 4, 5, 6, 6}) sut.take(even(i, 0));  // the last comes twice
  EXPECT_FALSE(sut.offset(even(6, 0).back_ns));
  sut.take(even(7, 0));
  EXPECT_TRUE(sut.offset(even(7, 0).back_ns));
}

// Eq. CK-4 with equal exchanges.  Below 5 s no drift is known.  The uncertainty is half of the
// round trip, 20e-6 of the time since the first exchange, and the distance of its offset from the
// median, that of number (i + 1)/2.  From then on the drift is exact, and half of the round trip is
// left.
TEST(ClockComparisonTest, WithoutJitterOffsetDriftAndUncertaintyAreExact) {
  ClockComparison sut;
  for (int i = 0; i < 64; ++i) {
    const std::int64_t ahead_ns = 3 * kSecond_ns + 12'500 * i;  // 50e-6
    const Exchange exchange = even(i, ahead_ns);
    sut.take(exchange);
    const auto out = sut.offset(exchange.back_ns + 10 * kSecond_ns);
    ASSERT_EQ(out.has_value(), i >= 7) << i;
    if (!out || i == 20) continue;  // at 5 s exactly a rounding decides
    ASSERT_EQ(std::isfinite(out->drift_sigma_ppm), i > 20) << i;
    ASSERT_NEAR(out->drift_ppm, i > 20 ? 50.0 : 0.0, 1e-3);
    ASSERT_EQ(out->round_trip_ns, 160'000);
    const double early_ns = 12'500.0 * ((i + 1) / 2) + 20e-6 * (0.25e9 * i + 10e9);
    ASSERT_NEAR(out->uncertainty_ns, 80e3 + (i > 20 ? 0.0 : early_ns), 2.0) << i;
    if (i > 20) {
      ASSERT_NEAR(static_cast<double>(out->offset_ns - ahead_ns), 500e3, 2.0);
    }
  }
}

// Eq. CK-5: the third in a row beyond half of the round trip, or 1 ms.
TEST(ClockComparisonTest, AStepIsTheThirdExchangeInARowBeyondTheBound) {
  for (const std::int64_t way_ns : {80'000, 2'000'000}) {
    for (const double share : {0.99, 1.01, -0.99, -1.01}) {
      const std::int64_t step_ns = std::llround(share * (way_ns == 80'000 ? 1e6 : 2e6));
      ClockComparison sut;
      for (int i = 0; i < 64; ++i) sut.take(even(i, 0, way_ns));
      for (int i = 64; i < 70; ++i) {  // two, one on the other side, and three again
        const auto found = sut.take(even(i, i == 66 ? -2 * step_ns : step_ns, way_ns));
        ASSERT_EQ(found.has_value(), i == 69 && std::abs(share) > 1.0) << share << " " << i;
        ASSERT_NEAR(static_cast<double>(found.value_or(step_ns) - step_ns), 0.0, 2.0);
      }
    }
  }
}

TEST(ClockComparisonTest, TheOffsetLiesWithinItsUncertaintyThoughOneExchangeInFiveIsHeldUp) {
  int within = 0;
  constexpr int kRuns = 200;
  for (int i = 0; i < kRuns; ++i) {
    ClockComparison sut;
    Network network{.held_up = 0.1, .draw = signal::Gaussian(static_cast<std::uint64_t>(i) + 1, 1)};
    run(sut, network, 64);
    const ClockOffset offset = *sut.offset(network.now_ns);
    within += std::abs(error_ns(sut, network)) <= offset.uncertainty_ns ? 1 : 0;
    EXPECT_LT(offset.uncertainty_ns, 200e3);
    EXPECT_EQ(offset.steps, 0);
  }
  EXPECT_EQ(within, kRuns);
}

// A busy machine: most exchanges wait, on either way.
TEST(ClockComparisonTest, TheUncertaintyHoldsThoughNineOfTenMessagesAreHeldUp) {
  int looked = 0;
  int outside = 0;
  for (int i = 0; i < 200; ++i) {
    ClockComparison sut;
    Network network{.held_up = 0.9, .draw = signal::Gaussian(static_cast<std::uint64_t>(i) + 1, 2)};
    for (int n = 8; n < 100; n += 4) {
      run(sut, network, n == 8 ? 8 : 4);
      const auto offset = sut.offset(network.now_ns);
      if (offset->steps > 0) break;  // it may look as if the clock had jumped: then all is new
      ++looked;
      outside += std::abs(error_ns(sut, network)) <= offset->uncertainty_ns ? 0 : 1;
    }
  }
  EXPECT_GT(looked, 1000);
  // The drift's share of the width is three sigma, no bound.
  EXPECT_LE(outside, looked / 500) << looked;
}

TEST(ClockComparisonTest, AWayThatIsAlwaysLongerThanTheWayBackStaysWithinTheUncertainty) {
  ClockComparison sut;
  Network network;
  for (int i = 0; i < 64; ++i) {
    Exchange exchange = network.exchange();
    exchange.received_ns += 300'000;  // the way there takes 0.3 ms more
    exchange.answered_ns += 300'000;
    exchange.back_ns += 300'000;
    sut.take(exchange);
  }
  const double error = error_ns(sut, network);
  EXPECT_NEAR(error, 150e3, 40e3);
  EXPECT_LE(std::abs(error), sut.offset(network.now_ns)->uncertainty_ns);
}

TEST(ClockComparisonTest, ADriftOf50PpmIsNoticedAndMeasured) {
  ClockComparison sut;
  Network network{.drift = 50e-6, .held_up = 0.1};
  run(sut, network, 64);
  const ClockOffset offset = *sut.offset(network.now_ns);
  EXPECT_NEAR(offset.drift_ppm, 50.0, 3.0 * offset.drift_sigma_ppm);
  EXPECT_LT(offset.drift_sigma_ppm, 8.0);
  EXPECT_TRUE(offset.drifts());
  EXPECT_LE(std::abs(error_ns(sut, network)), offset.uncertainty_ns);
  EXPECT_EQ(offset.steps, 0);
}

TEST(ClockComparisonTest, AClockThatKeepsTimeIsNeverSaidToDriftOrJump) {
  ClockComparison sut;
  Network network{.drift = 5e-6, .held_up = 0.3};
  for (int i = 0; i < 4 * 3600; ++i) {
    EXPECT_FALSE(sut.take(network.exchange())) << i;
    if (const auto offset = sut.offset(network.now_ns)) {
      EXPECT_FALSE(offset->drifts()) << i;
    }
  }
}

TEST(ClockComparisonTest, AStepIsNoticedWithinThreeExchangesAndTheNewOffsetIsRight) {
  for (const std::int64_t jump_ns : {20'000'000L, -20'000'000L, 3600L * kSecond_ns}) {
    ClockComparison sut;
    Network network{.held_up = 0.1};
    run(sut, network, 100);
    network.offset_ns += jump_ns;
    int needed = 0;
    std::optional<std::int64_t> step_ns;
    while (needed < 20 && !(step_ns = sut.take(network.exchange()))) ++needed;
    EXPECT_LE(needed, 6);  // one or two of them may have been held up
    run(sut, network, 16);
    const ClockOffset offset = *sut.offset(network.now_ns);
    EXPECT_EQ(offset.steps, 1);
    ASSERT_TRUE(step_ns);
    EXPECT_NEAR(static_cast<double>(*step_ns), static_cast<double>(jump_ns), 10.5e6);
    EXPECT_LE(std::abs(error_ns(sut, network)), offset.uncertainty_ns);
  }
}

TEST(ClockComparisonTest, WhatIsNoExchangeIsPassedOver) {
  ClockComparison sut;
  Network network;
  run(sut, network, 20);
  const ClockOffset before = *sut.offset(network.now_ns);
  const Exchange good = network.exchange();
  sut.take({good.back_ns, good.received_ns, good.answered_ns, good.asked_ns});
  sut.take({good.asked_ns, good.answered_ns, good.received_ns, good.back_ns});
  sut.take({good.asked_ns - 5 * kSecond_ns, good.received_ns, good.answered_ns, good.back_ns});
  sut.take({0, 0, 0, 0});
  const ClockOffset after = *sut.offset(network.now_ns - kEvery_ns);
  EXPECT_EQ(before.offset_ns, after.offset_ns);
  EXPECT_EQ(before.steps, after.steps);
}

// Anybody on the bus may write any stamp: a difference that wraps round would be one nanosecond.
TEST(ClockComparisonTest, StampsThatNoDifferenceCanHoldAreNoExchange) {
  ClockComparison sut;
  for (std::int64_t back_ns = kSecond_ns; back_ns < 20 * kSecond_ns; back_ns += kEvery_ns) {
    EXPECT_FALSE(sut.take({back_ns - 1000, INT64_MAX, INT64_MIN, back_ns}));
    EXPECT_FALSE(sut.take({INT64_MIN, INT64_MAX, INT64_MAX, back_ns}));
  }
  EXPECT_FALSE(sut.offset(20 * kSecond_ns));
}

}  // namespace
}  // namespace stillhand::clock::clock_comparison_test

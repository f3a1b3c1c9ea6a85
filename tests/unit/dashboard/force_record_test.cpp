// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/force_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace stillhand::dashboard::force_record_test {

void both(ForceRecord& record, Tick tick, double measured_n, double predicted_n) {
  record.measured(tick, measured_n);
  record.predicted(tick, predicted_n);
}

TEST(ForceRecordTest, ResidualIsMeasuredMinusPredictedInWhateverOrderTheyCome) {
  ForceRecord sut;
  for (Tick tick = 0; tick < 200; ++tick) {
    sut.predicted(tick + 5, 1.0);
    sut.measured(tick, static_cast<double>(tick));
  }
  const auto signals = sut.newest();
  // From the first tick with both; the newest 60 wait for the slower topic.
  ASSERT_EQ(signals.residual_n.size(), 140u);
  EXPECT_EQ(signals.force_n.front(), 5.0);
  EXPECT_EQ(signals.residual_n.front(), 4.0);
  EXPECT_EQ(signals.bridged, 0u);
}

TEST(ForceRecordTest, AShortGapIsBridgedByALineAndALongOneBeginsAnew) {
  ForceRecord sut;
  for (Tick tick = 0; tick < 1000; ++tick) {
    if (tick >= 300 && tick < 300 + ForceRecord::kBridged + 1) continue;
    if (tick >= 700 && tick < 703) continue;
    both(sut, tick, static_cast<double>(tick), 0.0);
  }
  const auto signals = sut.newest();
  EXPECT_EQ(signals.bridged, 3u);
  ASSERT_EQ(signals.force_n.size(), 940u - 311u);
  for (std::size_t i = 0; i < signals.force_n.size(); ++i) {
    ASSERT_NEAR(signals.force_n[i], 311.0 + static_cast<double>(i), 1e-9) << i;
  }
}

TEST(ForceRecordTest, HoldsTheNewestTwentySeconds) {
  ForceRecord sut;
  for (Tick tick = 0; tick < 50'000; ++tick) both(sut, tick, static_cast<double>(tick), 0.0);
  const auto signals = sut.newest();
  EXPECT_EQ(signals.force_n.size(), ForceRecord::kTicks - 60);
  EXPECT_EQ(signals.force_n.back(), 49'939.0);
}

TEST(ForceRecordTest, TicksThatGoFarBackAreAnotherSession) {
  ForceRecord sut;
  for (Tick tick = 90'000; tick < 91'000; ++tick) both(sut, tick, 7.0, 0.0);
  for (Tick tick = 0; tick < 100; ++tick) both(sut, tick, 1.0, 0.0);
  const auto signals = sut.newest();
  EXPECT_EQ(signals.force_n, std::vector<double>(40, 1.0));
}

// The row of tick 0 would take the place of the newest row, and later ticks would look recent.
TEST(ForceRecordTest, ASessionThatRestartsExactlyTheLengthOfTheRecordLaterIsAnother) {
  ForceRecord sut;
  for (Tick tick = 0; tick <= static_cast<Tick>(ForceRecord::kTicks); ++tick) {
    both(sut, tick, 7.0, 0.0);
  }
  for (Tick tick = 0; tick < 100; ++tick) both(sut, tick, 1.0, 0.0);
  EXPECT_EQ(sut.newest().force_n, std::vector<double>(40, 1.0));
}

TEST(ForceRecordTest, AForceThatIsNotFiniteIsAGap) {
  ForceRecord sut;
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (Tick tick = 0; tick < 200; ++tick) {
    both(sut, tick, tick == 50 ? std::nan("") : 2.0, tick == 60 ? kInf : 0.5);
  }
  const auto signals = sut.newest();
  EXPECT_EQ(signals.bridged, 2u);
  EXPECT_EQ(signals.force_n, std::vector<double>(140, 2.0));
  EXPECT_EQ(signals.residual_n, std::vector<double>(140, 1.5));
}

TEST(ForceRecordTest, WithoutATickOfBothTopicsItIsEmpty) {
  ForceRecord sut;
  EXPECT_TRUE(sut.newest().force_n.empty());
  sut.measured(-1, 1.0);
  for (Tick tick = 0; tick < 500; ++tick) {
    if (tick % 2 == 0) sut.measured(tick, 1.0);
    if (tick % 2 == 1) sut.predicted(tick, 1.0);
  }
  EXPECT_TRUE(sut.newest().force_n.empty());
}

}  // namespace stillhand::dashboard::force_record_test

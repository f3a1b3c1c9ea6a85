// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/force_record.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard {
namespace {

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

}  // namespace
}  // namespace stillhand::dashboard

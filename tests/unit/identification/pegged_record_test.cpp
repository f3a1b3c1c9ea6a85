// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/pegged_record.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace stillhand::identification::pegged_record_test {
namespace {

constexpr Trial kTrial{7, TrialPhase::kPegged, 1000, 5, 100};

// The acceleration of a tick is its number, the force twice that.
bool take(PeggedRecord& sut, Tick tick) {
  return sut.take(tick, static_cast<double>(tick), 2.0 * static_cast<double>(tick));
}

PeggedTrial collected(const std::vector<Tick>& ticks) {
  PeggedRecord sut;
  sut.begin(kTrial);
  for (const Tick tick : ticks) {
    if (take(sut, tick)) break;
  }
  EXPECT_FALSE(sut.active());
  return sut.release();
}

const std::vector<double> kWhole{1000.0, 1001.0, 1002.0, 1003.0, 1004.0};

TEST(PeggedRecordTest, CollectsTheMeasuredTicksAlone) {
  PeggedRecord sut;
  EXPECT_FALSE(take(sut, 1000));  // no trial yet
  sut.begin(kTrial);
  for (Tick tick = 900; tick < 1004; ++tick) ASSERT_FALSE(take(sut, tick)) << tick;
  EXPECT_TRUE(sut.active());
  EXPECT_TRUE(take(sut, 1004));
  EXPECT_FALSE(take(sut, 1005));
  const PeggedTrial trial = sut.release();
  EXPECT_EQ(trial.number, 7);
  EXPECT_EQ(trial.lost, 0);
  EXPECT_EQ(trial.record.rate_hz, 1000.0);
  EXPECT_EQ(trial.record.acceleration_m_s2, kWhole);
  EXPECT_EQ(trial.record.force_n.back(), 2008.0);
}

TEST(PeggedRecordTest, LostTicksAreInterpolated) {
  const PeggedTrial trial = collected({1000, 1003, 1004});
  EXPECT_EQ(trial.lost, 2);
  ASSERT_EQ(trial.record.size(), 5u);
  for (std::size_t n = 0; n < 5; ++n) {
    // Thirds are not exact in binary: one rounding each of share, product and sum.
    EXPECT_DOUBLE_EQ(trial.record.acceleration_m_s2[n], kWhole[n]);
    EXPECT_DOUBLE_EQ(trial.record.force_n[n], 2.0 * kWhole[n]);
  }
}

TEST(PeggedRecordTest, TicksLostAtTheStartRepeatTheFirstSample) {
  const PeggedTrial trial = collected({1002, 1003, 1004});
  EXPECT_EQ(trial.lost, 2);
  EXPECT_EQ(trial.record.acceleration_m_s2,
            (std::vector<double>{1002.0, 1002.0, 1002.0, 1003.0, 1004.0}));
}

TEST(PeggedRecordTest, TicksLostAtTheEndShortenTheRecord) {
  const PeggedTrial trial = collected({1000, 1001, 1002, 1200});
  EXPECT_EQ(trial.lost, 0);
  EXPECT_EQ(trial.record.acceleration_m_s2, (std::vector<double>{1000.0, 1001.0, 1002.0}));
}

TEST(PeggedRecordTest, ATickThatDoesNotIncreaseIsIgnored) {
  const PeggedTrial trial = collected({1000, 1001, 1001, 1000, 1002, 1003, 1004});
  EXPECT_EQ(trial.lost, 0);
  EXPECT_EQ(trial.record.acceleration_m_s2, kWhole);
}

TEST(PeggedRecordTest, AnotherTrialBeginsEmpty) {
  PeggedRecord sut;
  sut.begin(kTrial);
  take(sut, 1000);
  take(sut, 1003);
  sut.begin({8, TrialPhase::kPegged, 2000, 2, 100});
  take(sut, 2000);
  EXPECT_TRUE(take(sut, 2001));
  const PeggedTrial trial = sut.release();
  EXPECT_EQ(trial.number, 8);
  EXPECT_EQ(trial.lost, 0);
  EXPECT_EQ(trial.record.acceleration_m_s2, (std::vector<double>{2000.0, 2001.0}));
}

TEST(PeggedRecordTest, MoreThanOnePercentOfLostTicksIsUnusable) {
  PeggedTrial trial;
  trial.record.force_n.resize(1000);
  trial.lost = 10;
  EXPECT_EQ(why_unusable(trial), "");
  trial.lost = 11;
  EXPECT_EQ(why_unusable(trial), "11 ticks of the pegged trial were lost");
}

}  // namespace
}  // namespace stillhand::identification::pegged_record_test

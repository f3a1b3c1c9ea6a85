// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/traces.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard::traces_test {

TEST(TracesTest, EveryTwentiethTickOfTheNewestTenSecondsIsKept) {
  Traces sut;
  for (Tick tick = 0; tick < 25'000; ++tick) {
    sut.put(tick, Signal::kForce, static_cast<double>(tick));
  }
  const auto rows = sut.rows();
  ASSERT_GT(rows.size(), 490u);
  EXPECT_LE(rows.size(), Traces::kRows);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_EQ(rows[i].tick, rows.front().tick + static_cast<Tick>(i) * Traces::kEvery);
    EXPECT_EQ(rows[i].values[static_cast<std::size_t>(Signal::kForce)],
              static_cast<double>(rows[i].tick));
    EXPECT_TRUE(std::isnan(rows[i].values[static_cast<std::size_t>(Signal::kTarget)]));
  }
}

TEST(TracesTest, ARowIsToldOnceEveryTopicHadTheTimeToFillIt) {
  Traces sut;
  for (Tick tick = 0; tick <= 200; tick += Traces::kEvery) {
    sut.put(tick, Signal::kForce, 1.0);
    if (tick >= 40) sut.put(tick - 40, Signal::kMotorForce, 2.0);
  }
  const auto rows = sut.rows(60);
  ASSERT_EQ(rows.size(), 4u);  // 80 to 140
  for (const auto& row : rows) {
    EXPECT_EQ(row.values[static_cast<std::size_t>(Signal::kMotorForce)], 2.0);
  }
  EXPECT_TRUE(sut.rows(140).empty());
}

TEST(TracesTest, TicksThatGoBackAreAnotherSession) {
  Traces sut;
  for (Tick tick = 0; tick < 60'000; ++tick) sut.put(tick, Signal::kForce, 1.0);
  for (Tick tick = 0; tick < 1000; ++tick) sut.put(tick, Signal::kForce, 2.0);
  for (const auto& row : sut.rows()) {
    EXPECT_LT(row.tick, 1000);
    EXPECT_EQ(row.values[static_cast<std::size_t>(Signal::kForce)], 2.0);
  }
  EXPECT_FALSE(sut.rows().empty());
}

// The row of tick 0 would take the place of the newest row, and later ticks would look recent.
TEST(TracesTest, ASessionThatRestartsExactlyTheLengthOfTheTraceLaterIsAnother) {
  Traces sut;
  const Tick length = static_cast<Tick>(Traces::kRows) * Traces::kEvery;
  for (Tick tick = 0; tick <= length; ++tick) sut.put(tick, Signal::kForce, 1.0);
  for (Tick tick = 0; tick <= 200; ++tick) sut.put(tick, Signal::kForce, 2.0);
  const auto rows = sut.rows();
  ASSERT_EQ(rows.size(), 8u);  // 0 to 140; the newest 60 ticks wait for the slower topics
  for (const auto& row : rows) {
    EXPECT_LE(row.tick, 140);
    EXPECT_EQ(row.values[static_cast<std::size_t>(Signal::kForce)], 2.0);
  }
}

TEST(TracesTest, ALateTickThatIsStillInsideTheTraceKeepsTheOthers) {
  Traces sut;
  const Tick length = static_cast<Tick>(Traces::kRows) * Traces::kEvery;
  for (Tick tick = 0; tick <= length; tick += Traces::kEvery) sut.put(tick, Signal::kForce, 1.0);
  sut.put(Traces::kEvery, Signal::kCursor, 3.0);
  const auto rows = sut.rows();
  ASSERT_EQ(rows.size(), Traces::kRows - 3);
  EXPECT_EQ(rows.front().tick, Traces::kEvery);
  EXPECT_EQ(rows.front().values[static_cast<std::size_t>(Signal::kForce)], 1.0);
  EXPECT_EQ(rows.front().values[static_cast<std::size_t>(Signal::kCursor)], 3.0);
}

TEST(TracesTest, NegativeTicksAndTicksBetweenTheRowsAreIgnored) {
  Traces sut;
  for (const Tick tick :
       {Tick{-1}, Tick{-20}, std::numeric_limits<Tick>::min(), Tick{19}, Tick{21}}) {
    sut.put(tick, Signal::kForce, 1.0);
  }
  sut.put(200, Signal::kTarget, 1.0);
  EXPECT_TRUE(sut.rows().empty()) << "the row of tick 200 waits for the other topics";
  sut.put(260, Signal::kTarget, 1.0);
  ASSERT_EQ(sut.rows().size(), 1u);
  EXPECT_EQ(sut.rows().front().tick, 200);
}

}  // namespace stillhand::dashboard::traces_test

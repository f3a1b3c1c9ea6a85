// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/libraries/measurement/read.hpp"
#include "services/core/contract/config_error.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::measurement::join_test {

using diagnosis::Measurement;
using testing::ElementsAre;
using testing::HasSubstr;

Measurement part(const std::string& source, double start_s, double value) {
  Measurement sut;
  sut.source = source;
  sut.rate_hz = 10.0;
  sut.channels = {{"a_y", "m/s^2", {value, value + 1.0}}, {"f", "N", {-value, -value - 1.0}}};
  sut.weight = {1.0, 0.0};
  sut.stretches = {{0, 2, start_s}};
  sut.notes = {"1 row missing."};
  return sut;
}

std::string error_of(const Measurement& one, const Measurement& other) {
  return support::refusal([&] { (void)join({one, other}); });
}

TEST(JoinTest, OneRecordingStaysAsItIs) {
  const Measurement sut = join({part("a.csv", 5.0, 1.0)});
  EXPECT_EQ(sut.source, "a.csv");
  EXPECT_THAT(sut.notes, ElementsAre("1 row missing."));
  EXPECT_EQ(sut.stretches[0].start_s, 5.0);
}

TEST(JoinTest, EveryRecordingIsAStretchAndTimeGoesOn) {
  Measurement second = part("b.csv", 100.0, 10.0);
  second.channels[0].values = {10.0, 11.0, 12.0};
  second.channels[1].values = {1.0, 2.0, 3.0};
  second.weight = {1.0, 1.0, 1.0};
  second.stretches = {{0, 1, 100.0}, {1, 3, 107.0}};
  const Measurement sut = join({part("a.csv", 5.0, 1.0), second});
  check(sut);
  EXPECT_EQ(sut.source, "a.csv, b.csv");
  EXPECT_THAT(sut.find("a_y")->values, ElementsAre(1.0, 2.0, 10.0, 11.0, 12.0));
  EXPECT_THAT(sut.weight, ElementsAre(1.0, 0.0, 1.0, 1.0, 1.0));
  ASSERT_EQ(sut.stretches.size(), 3u);
  EXPECT_EQ(sut.stretches[1].first, 2u);
  EXPECT_DOUBLE_EQ(sut.stretches[1].start_s, 5.2);
  EXPECT_DOUBLE_EQ(sut.stretches[2].start_s, 12.2);  // 7 s later, as in its own file
  EXPECT_EQ(sut.stretches[0].recording, 0u);
  EXPECT_EQ(sut.stretches[1].recording, 1u);
  EXPECT_EQ(sut.stretches[2].recording, 1u);
  EXPECT_THAT(sut.notes, ElementsAre("a.csv: 1 row missing.", "b.csv: 1 row missing."));
}

// Each of 0.2 s; a part that was joined before keeps its recordings apart.
TEST(JoinTest, FaultsGoOnInTimeAndRecordingsAreCounted) {
  Measurement second = part("b.csv", 100.0, 10.0);
  second.stretches = {{0, 1, 100.0, 0}, {1, 2, 100.1, 1}};
  second.screening = {{"f", "spikes", {100.0, 100.1}, 1.0, "", false}};
  const Measurement sut = join({part("a.csv", 5.0, 1.0), second, part("c.csv", -7.0, 3.0)});
  ASSERT_EQ(sut.stretches.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(sut.stretches[i].recording, i);
  EXPECT_DOUBLE_EQ(sut.stretches[3].start_s, 5.4);
  EXPECT_EQ(sut.stretches[3].first, 4u);
  EXPECT_EQ(sut.stretches[3].end, 6u);
  EXPECT_THAT(sut.screening.at(0).times_s,
              ElementsAre(testing::DoubleEq(5.2), testing::DoubleEq(5.3)));
  EXPECT_THAT(sut.notes, ElementsAre("a.csv: 1 row missing.", "b.csv: 1 row missing.",
                                     "c.csv: 1 row missing."));
}

TEST(JoinTest, ColumnsInAnotherOrderFindTheirChannel) {
  Measurement second = part("b.csv", 0.0, 10.0);
  std::swap(second.channels[0], second.channels[1]);
  const Measurement sut = join({part("a.csv", 0.0, 1.0), second});
  EXPECT_THAT(sut.find("f")->values, ElementsAre(-1.0, -2.0, -10.0, -11.0));
}

TEST(JoinTest, AThousandthOfTheRateIsTheSameRate) {
  Measurement second = part("b.csv", 0.0, 10.0);
  second.rate_hz = 10.009;
  EXPECT_EQ(error_of(part("a.csv", 0.0, 1.0), second), "accepted");
  for (const double rate_hz : {9.98, 9.989, 10.011}) {
    second.rate_hz = rate_hz;
    EXPECT_NE(error_of(part("a.csv", 0.0, 1.0), second), "accepted") << rate_hz;
  }
  second.rate_hz = 10.02;
  EXPECT_THAT(error_of(part("a.csv", 0.0, 1.0), second),
              HasSubstr("b.csv: got 10.020000 Hz, want 10.000000 Hz as a.csv has"));
}

TEST(JoinTest, ChannelsThatDifferAreNamed) {
  Measurement renamed = part("b.csv", 0.0, 10.0);
  renamed.channels[1].name = "force";
  EXPECT_THAT(error_of(part("a.csv", 0.0, 1.0), renamed),
              HasSubstr("channels a_y [m/s^2], force [N], want f [N] too, as a.csv has"));
  Measurement other_unit = part("b.csv", 0.0, 10.0);
  other_unit.channels[1].unit = "lbf";
  EXPECT_THAT(error_of(part("a.csv", 0.0, 1.0), other_unit),
              HasSubstr("b.csv: got f [lbf], want f [N] as a.csv has"));
  Measurement more = part("b.csv", 0.0, 10.0);
  more.channels.push_back({"roll", "rad", {0.0, 0.0}});
  EXPECT_THAT(error_of(part("a.csv", 0.0, 1.0), more), HasSubstr("roll [rad] in addition"));
}

TEST(JoinTest, WhatTheScreeningOfOneLeftOutIsLeftOutOfAll) {
  Measurement screened = part("b.csv", 5.0, 2.0);
  const std::string lacking = screened.channels.back().name;
  screened.channels.pop_back();
  EXPECT_THAT(error_of(part("a.csv", 5.0, 1.0), screened), testing::HasSubstr(lacking));
  screened.screening.push_back({lacking, "stuck", {}, 1.0, "", false});
  const Measurement sut = join({part("a.csv", 5.0, 1.0), screened});
  EXPECT_EQ(sut.find(lacking), nullptr);
  EXPECT_THAT(sut.notes, testing::Contains(testing::HasSubstr(lacking + " left out, as in b.csv")));
}

TEST(JoinTest, NothingIsRefused) { EXPECT_THROW((void)join({}), ConfigError); }

}  // namespace stillhand::measurement::join_test

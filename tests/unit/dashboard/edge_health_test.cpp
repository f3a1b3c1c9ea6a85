// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/edge_health.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard::edge_health_test {

EndCounts counts(std::uint64_t samples, std::uint64_t cycle_misses, std::uint64_t lost_ticks) {
  EndCounts counts;
  counts.samples = samples;
  counts.cycle_misses = cycle_misses;
  counts.lost_ticks = lost_ticks;
  return counts;
}

TEST(EdgeHealthTest, TellsWhenACountFirstGrewAndWhenItDidLast) {
  EdgeHealth sut;
  sut.step(counts(100, 0, 0), 1);
  sut.step(counts(200, 2, 0), 2);
  sut.step(counts(300, 2, 5), 3);
  sut.step(counts(400, 3, 5), 4);
  EXPECT_EQ(sut.late().first_at_ns, 2);
  EXPECT_EQ(sut.late().last_at_ns, 4);
  EXPECT_EQ(sut.lost().first_at_ns, 3);
  EXPECT_EQ(sut.lost().last_at_ns, 3);
  EXPECT_EQ(sut.counts().cycle_misses, 3u);
}

TEST(EdgeHealthTest, DdsCountIsApart) {
  EdgeHealth sut;
  EndCounts missed = counts(200, 0, 0);
  missed.deadline_misses = 1;
  sut.step(counts(100, 0, 0), 1);
  sut.step(missed, 2);
  EXPECT_EQ(sut.missed().first_at_ns, 2);
  EXPECT_EQ(sut.late().first_at_ns, 0);
}

TEST(EdgeHealthTest, WhatWasCountedBeforeTheFirstReportHasNoTime) {
  EdgeHealth sut;
  sut.step(counts(100, 7, 7), 1);
  sut.step(counts(200, 7, 7), 2);
  EXPECT_EQ(sut.late().first_at_ns, 0);
  EXPECT_EQ(sut.lost().last_at_ns, 0);
}

TEST(EdgeHealthTest, AnotherProcessOfThatNameBeginsAnew) {
  EdgeHealth sut;
  sut.step(counts(100, 0, 0), 1);
  sut.step(counts(200, 9, 0), 2);
  sut.step(counts(10, 1, 0), 3);
  EXPECT_EQ(sut.late().first_at_ns, 0);
  EXPECT_EQ(sut.counts().cycle_misses, 1u);
}

}  // namespace stillhand::dashboard::edge_health_test

// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/qos_mismatches.hpp"

#include <gtest/gtest.h>

namespace stillhand::dashboard::qos_mismatches_test {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(QosMismatchesTest, ToldAgainItIsTheSameSinceTheFirstTime) {
  QosMismatches sut;
  sut.note("sensing", "stillhand/sensed", "RELIABILITY", 1 * kSecond);
  sut.note("sensing", "stillhand/sensed", "RELIABILITY, 3 times", 5 * kSecond);
  sut.note("sensing", "stillhand/sensed", "DEADLINE", 6 * kSecond);
  ASSERT_EQ(sut.all().size(), 2u);
  EXPECT_EQ(sut.all()[0].policy, "RELIABILITY");
  EXPECT_EQ(sut.all()[0].since_ns, 1 * kSecond);
  EXPECT_EQ(sut.all()[0].last_ns, 5 * kSecond);
}

TEST(QosMismatchesTest, IsOverWhenAnotherProcessOfThatNameBegins) {
  QosMismatches sut;
  sut.note("sensing", "stillhand/sensed", "RELIABILITY", 1 * kSecond);
  sut.note("rig", "stillhand/sensed", "RELIABILITY", 1 * kSecond);
  // Its own first word of one comes just before its first status.
  sut.note("sensing", "stillhand/raw_sample", "DEADLINE", 20 * kSecond);
  sut.begun("sensing", 20 * kSecond + kSecond / 10);
  ASSERT_EQ(sut.all().size(), 2u);
  EXPECT_EQ(sut.all()[0].service, "rig");
  EXPECT_EQ(sut.all()[1].topic, "stillhand/raw_sample");
}

TEST(QosMismatchesTest, HoldsABoundedNumberOfThem) {
  QosMismatches sut;
  for (int i = 0; i < 1000; ++i) sut.note("rig", "topic" + std::to_string(i), "DEADLINE", i);
  EXPECT_EQ(sut.all().size(), 64u);
  EXPECT_EQ(sut.all().back().topic, "topic999");
}

}  // namespace stillhand::dashboard::qos_mismatches_test

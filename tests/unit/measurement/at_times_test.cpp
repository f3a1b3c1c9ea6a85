// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/at_times.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::measurement::at_times_test {

TEST(AtTimesTest, ACubicIsMetAndARowIsUnchanged) {
  const auto cubic = [](double t) { return 1.0 + t * (2.0 - t * (3.0 - t)); };
  std::vector<double> time_s;
  std::vector<double> values;
  for (int i = 0; i < 20; ++i) {
    time_s.push_back(0.1 * i + 0.01 * (i % 3));
    values.push_back(cubic(time_s.back()));
  }
  const std::vector<double> wanted{time_s[3], 0.47, 0.951, time_s[19]};
  const std::vector<double> sut = at_times(time_s, values, wanted, 1.0);
  EXPECT_EQ(sut[0], values[3]);
  EXPECT_EQ(sut[3], values[19]);
  // The cubic itself, but for some twenty roundings of numbers near 1.
  EXPECT_NEAR(sut[1], cubic(0.47), 1e-14);
  EXPECT_NEAR(sut[2], cubic(0.951), 1e-14);
}

TEST(AtTimesTest, NothingIsInventedOutsideAndInGaps) {
  const std::vector<double> time_s{0.0, 0.1, 0.2, 0.9, 1.0, 1.1};
  const std::vector<double> values{0.0, 1.0, 2.0, 9.0, 10.0, 11.0};
  const std::vector<double> sut =
      at_times(time_s, values, {-0.1, 0.05, 0.15, 0.5, 0.95, 1.05, 1.2}, 0.4);
  EXPECT_TRUE(std::isnan(sut[0]));
  EXPECT_NEAR(sut[1], 0.5, 1e-14);
  EXPECT_NEAR(sut[2], 1.5, 1e-14) << "the row beyond the gap does not count";
  EXPECT_TRUE(std::isnan(sut[3]));
  EXPECT_NEAR(sut[4], 9.5, 1e-13);
  EXPECT_NEAR(sut[5], 10.5, 1e-13);
  EXPECT_TRUE(std::isnan(sut[6]));
  EXPECT_TRUE(std::isnan(at_times({}, {}, {0.0}, 1.0)[0]));
}

}  // namespace stillhand::measurement::at_times_test

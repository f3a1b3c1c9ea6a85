// SPDX-License-Identifier: Apache-2.0
#include "services/runtime/process/cpu_share.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::runtime {
namespace {

TEST(ShareMeterTest, TellsTheShareOfEachWholeSecond) {
  ShareMeter sut;
  EXPECT_TRUE(std::isnan(sut.step(500, 10'000, 1000)));
  EXPECT_TRUE(std::isnan(sut.step(600, 10'900, 1000)));  // not yet a second
  EXPECT_DOUBLE_EQ(sut.step(750, 11'000, 1000), 0.25);
  EXPECT_DOUBLE_EQ(sut.step(900, 11'500, 1000), 0.25);  // of the second before
  EXPECT_DOUBLE_EQ(sut.step(1750, 12'000, 1000), 1.0);
}

// Busy until the meter tells of a whole second.
template <typename Meter>
double busy_share(Meter meter) {
  double share = meter.step();
  volatile double sink = 1.0;
  while (std::isnan(share)) {
    for (int i = 0; i < 10'000; ++i) sink = std::sqrt(sink + 1.0);
    share = meter.step();
  }
  return share;
}

TEST(ProcessCpuTest, ABusySecondCounts) {
  const double share = busy_share(ProcessCpu());
  EXPECT_GT(share, 0.0);
  EXPECT_LE(share, 1.1);
}

TEST(HostCpuTest, IsAShareOfTheWhole) {
  const double share = busy_share(HostCpu());
  EXPECT_GT(share, 0.0);
  EXPECT_LE(share, 1.0);
}

}  // namespace
}  // namespace stillhand::runtime

// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/delay_line.hpp"

#include <gtest/gtest.h>

namespace stillhand::signal::delay_line_test {
namespace {

TEST(DelayLineTest, GivesTheInputOfThatManySamplesAgo) {
  for (const std::size_t delay : {0u, 1u, 2u, 7u, 100u}) {
    DelayLine sut(delay);
    for (std::size_t n = 0; n < 350; ++n) {
      const double expected = n >= delay ? static_cast<double>(n - delay) + 1.0 : 0.0;
      ASSERT_EQ(sut.step(static_cast<double>(n) + 1.0), expected) << delay << " at " << n;
    }
  }
}

TEST(DelayLineTest, ResetFillsItWithZero) {
  DelayLine sut(3);
  for (int n = 0; n < 10; ++n) sut.step(5.0);
  sut.reset();
  for (int n = 0; n < 3; ++n) EXPECT_EQ(sut.step(1.0), 0.0);
  EXPECT_EQ(sut.step(2.0), 1.0);
}

// A delay that changes reads another sample of the same past; one beyond the line is its end.
TEST(DelayLineTest, TheDelayMayChangeFromSampleToSample) {
  DelayLine sut(5);
  for (int n = 0; n < 40; ++n) {
    const int delay = n % 8;
    const int expected = n - (delay > 5 ? 5 : delay);
    EXPECT_EQ(sut.step(n, static_cast<std::size_t>(delay)), expected < 0 ? 0.0 : expected) << n;
  }
}

}  // namespace
}  // namespace stillhand::signal::delay_line_test

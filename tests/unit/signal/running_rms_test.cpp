// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/running_rms.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::signal::running_rms_test {
namespace {

// Eq. SG-17: after a step of 3 the mean square is 9 (1 - exp(-t/T)); the discrete steps differ from
// the exponential by dt / 2T = 1.25e-4.
TEST(RunningRmsTest, ApproachesTheRmsWithItsMemory) {
  RunningRms sut(4.0);
  EXPECT_EQ(sut.value(), 0.0);
  for (int n = 0; n < 4000; ++n) sut.step(-3.0);
  EXPECT_NEAR(sut.value(), 3.0 * std::sqrt(1.0 - std::exp(-1.0)), 1e-3);
  for (int n = 0; n < 100000; ++n) sut.step(3.0);
  EXPECT_NEAR(sut.value(), 3.0, 1e-9);
  sut.reset();
  EXPECT_EQ(sut.value(), 0.0);
}

}  // namespace
}  // namespace stillhand::signal::running_rms_test

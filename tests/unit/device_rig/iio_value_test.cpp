// SPDX-License-Identifier: Apache-2.0
// Eq. DR-13.
#include "services/core/device_rig/iio_value.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace stillhand::device_rig::iio_value_test {

// The example of Linux, Documentation/ABI/testing/sysfs-bus-iio: value = (raw + offset) * scale.
TEST(IioValueTest, IsTheSumOfNumberAndOffsetTimesTheScale) {
  EXPECT_DOUBLE_EQ(iio_value(250, -3.0, 0.5, -512, 511), 123.5);
  EXPECT_DOUBLE_EQ(iio_value(-511, 0.0, 2.0, -512, 511), -1022.0);
}

TEST(IioValueTest, AtAnEndOfTheConverterItIsNoMeasurement) {
  EXPECT_TRUE(std::isnan(iio_value(511, 0.0, 1.0, -512, 511)));
  EXPECT_TRUE(std::isnan(iio_value(-512, 0.0, 1.0, -512, 511)));
  EXPECT_FALSE(std::isnan(iio_value(510, 0.0, 1.0, -512, 511)));
}

}  // namespace stillhand::device_rig::iio_value_test

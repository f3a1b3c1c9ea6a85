// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/rotation.hpp"

#include <gtest/gtest.h>

namespace stillhand::recording::rotation_test {
namespace {

TEST(RotationTest, AFileIsFullBySizeOrByAgeWhicheverComesFirst) {
  EXPECT_FALSE(is_full({}, UINT64_MAX, INT64_MAX));
  EXPECT_FALSE(is_full({100, 0}, 99, INT64_MAX));
  EXPECT_TRUE(is_full({100, 0}, 100, 0));
  EXPECT_FALSE(is_full({0, 50}, UINT64_MAX, 49));
  EXPECT_TRUE(is_full({0, 50}, 0, 50));
  EXPECT_TRUE(is_full({100, 50}, 1, 50));
}

TEST(RotationTest, TheNumberStandsBeforeTheEndingAndSortsByName) {
  EXPECT_EQ(part_name("run.mcap", 1), "run.mcap");
  EXPECT_EQ(part_name("run.mcap", 2), "run.0002.mcap");
  EXPECT_EQ(part_name("a.b/run", 3), "a.b/run.0003");
  EXPECT_EQ(part_name("a.b/run.x.mcap", 10), "a.b/run.x.0010.mcap");
  EXPECT_EQ(part_name("/.hidden", 2), "/.hidden.0002");
  EXPECT_EQ(part_name("run.mcap", 12345), "run.12345.mcap");
}

}  // namespace
}  // namespace stillhand::recording::rotation_test

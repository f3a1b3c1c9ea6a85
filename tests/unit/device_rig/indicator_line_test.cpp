// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/indicator_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace stillhand::device_rig {
namespace {

// No maker printed these lines: the format is our own.  The forces are worked out by hand.
TEST(IndicatorLineTest, AWeightIsAForceInEachUnit) {
  // 12.345 g * 9.80665 m/s^2 = 0.12106309...  N; the tolerance is the rounding of a double.
  EXPECT_NEAR(indicator_force_n("N,+0012.345,g,ST").value(), 0.121063094, 1e-9);
  EXPECT_NEAR(indicator_force_n("N,-0012.345,g,US").value(), -0.121063094, 1e-9);
  EXPECT_NEAR(indicator_force_n("G,+0001.000,kg,ST").value(), 9.80665, 1e-12);
  EXPECT_NEAR(indicator_force_n("N,+0001.000,lb,ST").value(), 4.4482216152605, 1e-12);
  EXPECT_DOUBLE_EQ(indicator_force_n("N,-0025.000,N,ST").value(), -25.0);
}

TEST(IndicatorLineTest, AnOverloadIsNoMeasurement) {
  EXPECT_TRUE(std::isnan(indicator_force_n("N,+0000.000,g,OL").value()));
}

TEST(IndicatorLineTest, EveryPieceOfALineIsNone) {
  const std::string line = "N,+0012.345,g,ST";
  for (std::size_t begin = 0; begin <= line.size(); ++begin) {
    for (std::size_t size = 0; begin + size <= line.size(); ++size) {
      if (size == line.size()) continue;
      EXPECT_FALSE(indicator_force_n(line.substr(begin, size))) << begin << ' ' << size;
    }
  }
}

TEST(IndicatorLineTest, ALineWithoutOneOfItsCharactersIsNone) {
  const std::string line = "N,+0012.345,g,ST";
  for (std::size_t at = 0; at < line.size(); ++at) {
    EXPECT_FALSE(indicator_force_n(std::string(line).erase(at, 1))) << at;
  }
}

TEST(IndicatorLineTest, AnotherFormIsNone) {
  for (const char* line :
       {"N,+0012.345,oz,ST", "N,+0012.345,g,XX", "T,+0012.345,g,ST", "N, 0012.345,g,ST",
        "N,+0012.3e5,g,ST", "N,+0012.345,g,ST,", "N,+0012.345,g,ST ", "N,+00nan.00,g,ST"}) {
    EXPECT_FALSE(indicator_force_n(line)) << line;
  }
}

}  // namespace
}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/units.hpp"

#include <gtest/gtest.h>

namespace stillhand::measurement::units_test {

double converted(double value, const std::string& from, const std::string& to, Gain gain = {}) {
  const auto conversion = unit_conversion(from, gain, to);
  if (!conversion) return -1e300;
  std::vector<double> values{value};
  conversion->apply(values);
  return values[0];
}

TEST(UnitsTest, PrefixesAndDerivedUnitsBecomeSiUnits) {
  EXPECT_EQ(converted(2.0, "kN", "N"), 2000.0);
  EXPECT_EQ(converted(1500.0, "mm/s^2", "m/s^2"), 1.5);
  EXPECT_EQ(converted(3.0, "m/s²", "m/s^2"), 3.0);
  EXPECT_EQ(converted(3.0, "m s-2", "m/s^2"), 3.0);
  EXPECT_EQ(converted(3.0, "m/s/s", "m/s^2"), 3.0);
  EXPECT_EQ(converted(2.0, "min", "s"), 120.0);
  EXPECT_EQ(converted(7.0, "mNm", "N.m"), 0.007);
  // One rounding of pi/180 and one of the product.
  EXPECT_NEAR(converted(180.0, "deg", "rad"), 3.141592653589793, 1e-15);
  EXPECT_NEAR(converted(60.0, "rpm", "rad/s"), 2.0 * 3.141592653589793, 2e-15);
}

// 0.013 is not 13 times the double nearest to 0.001.
TEST(UnitsTest, ADecimalPartOfAUnitIsRoundedAsItsDecimalNumber) {
  for (int i = 1; i < 2000; ++i) {
    const std::string text = std::to_string(i);
    EXPECT_EQ(converted(i, "ms", "s"), std::stod(text + "e-3"));
    EXPECT_EQ(converted(i, "us", "s"), std::stod(text + "e-6"));
    EXPECT_EQ(converted(i, "µs", "s"), std::stod(text + "e-6"));
    EXPECT_EQ(converted(i, "ns", "s"), std::stod(text + "e-9"));
  }
}

TEST(UnitsTest, GIsGravityWhereAnAccelerationIsMeant) {
  EXPECT_DOUBLE_EQ(converted(2.0, "g", "m/s^2"), 2.0 * 9.80665);
  EXPECT_DOUBLE_EQ(converted(500.0, "mg", "m/s^2"), 0.5 * 9.80665);
  EXPECT_EQ(converted(500.0, "g", "kg"), 0.5) << "and a gram where a mass is";
}

TEST(UnitsTest, AGainBringsItsUnit) {
  EXPECT_DOUBLE_EQ(converted(2.0, "V", "N", {22.5, false, "N/V"}), 45.0);
  EXPECT_DOUBLE_EQ(converted(2000.0, "mV", "N", {22.5, false, "N/V"}), 45.0);
  EXPECT_DOUBLE_EQ(converted(204.8, "mV", "m/s^2", {102.4, true, "mV/g"}), 2.0 * 9.80665);
  EXPECT_DOUBLE_EQ(converted(0.5, "m/s^2", "m/s^2", {49.0, false, {}}), 24.5);
}

TEST(UnitsTest, EqualTextsNeedNoTable) {
  EXPECT_EQ(converted(3.0, "furlong per coffee", "furlong per coffee"), 3.0);
  EXPECT_EQ(converted(3.0, "-", ""), 3.0);
}

TEST(UnitsTest, WhatMeasuresSomethingElseIsRefused) {
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"V", "N"},
                                                        {"Hz", "s"},
                                                        {"m", "m/s^2"},
                                                        {"N", "N.m"},
                                                        {"dBm", "W"},
                                                        {"quux", "s"},
                                                        {"", "N"},
                                                        {std::string(500, '('), "s"},
                                                        {"s since 1970-01-01", "s"}}) {
    EXPECT_FALSE(unit_conversion(from, {}, to)) << from << " to " << to;
  }
}

TEST(UnitsTest, AScaleWithAnotherZeroIsMoved) {
  // 273.15 has an error of 3e-14 as a double.
  EXPECT_NEAR(converted(20.0, "degC", "K"), 293.15, 1e-12);
}

}  // namespace stillhand::measurement::units_test

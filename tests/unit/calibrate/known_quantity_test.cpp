// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/known_quantity.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::calibrate::known_quantity_test {
namespace {

using device_rig::CalibratedSignal;
using testing::DoubleEq;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(KnownQuantityTest, TakesTheSignalsUnitAndAnotherOne) {
  EXPECT_THAT(known_quantities("0, 5 N,-0.5kg", CalibratedSignal::kForce),
              ElementsAre(0.0, 5.0, DoubleEq(-0.5 * 9.80665)));
  EXPECT_THAT(known_quantities("1g,-9.8m/s^2", CalibratedSignal::kAcceleration),
              ElementsAre(DoubleEq(9.80665), -9.8));
  EXPECT_THAT(known_quantities("180deg,0.1 rad", CalibratedSignal::kAngle),
              ElementsAre(DoubleEq(std::numbers::pi), 0.1));
}

TEST(KnownQuantityTest, RefusesWhatIsNoQuantity) {
  for (const char* words : {"five", "5deg", "1,,2", "nan", "inf", "5 N m", ","}) {
    EXPECT_THROW(known_quantities(words, CalibratedSignal::kForce), ConfigError) << words;
  }
  EXPECT_THAT(known_quantities("", CalibratedSignal::kForce), IsEmpty());
}

TEST(KnownQuantityTest, SaysWhatToDo) {
  EXPECT_THAT(instruction(CalibratedSignal::kForce, -9.80665),
              HasSubstr("left with 9.807 N (1 kg"));
  EXPECT_THAT(instruction(CalibratedSignal::kAcceleration, 9.80665),
              HasSubstr("by 90 degrees, so that its right side is up"));
  EXPECT_THAT(instruction(CalibratedSignal::kAngle, 0.0), HasSubstr("upright"));
}

}  // namespace
}  // namespace stillhand::calibrate::known_quantity_test

// SPDX-License-Identifier: Apache-2.0
#include "apps/record/field_trigger.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "idl/control_loop.h"
#include "services/contract/config_error.hpp"
#include "tests/support/idl_fields.hpp"

namespace stillhand::record {
namespace {

TEST(FieldTriggerTest, FiresAtTheCrossingAndNotAgainBeforeItWasBack) {
  FieldTrigger sut("stillhand/sensed.accel_y_m_s2>5");
  EXPECT_FALSE(sut.step(5.0));
  EXPECT_TRUE(sut.step(5.1));
  EXPECT_FALSE(sut.step(9.0));
  EXPECT_FALSE(sut.step(-9.0));
  EXPECT_TRUE(sut.step(6.0));
  EXPECT_FALSE(sut.step(std::nan("")));
}

TEST(FieldTriggerTest, AMagnitudeCountsBothSides) {
  FieldTrigger sut("stillhand/sensed.|accel_y_m_s2|>5");
  EXPECT_TRUE(sut.step(-6.0));
  FieldTrigger below("stillhand/sensed.force_n<-2.5");
  EXPECT_FALSE(below.step(-2.5));
  EXPECT_TRUE(below.step(-2.6));
}

TEST(FieldTriggerTest, ReadsTheFieldFromTheBytesOfItsTopicOnly) {
  FieldTrigger sut("stillhand/sensed.theta_rad>0.2");
  stillhand_msgs::Sensed message;
  message.theta_rad(0.3);
  std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  for (const char c : tests::cdr_of(message)) bytes.push_back(static_cast<std::byte>(c));
  runtime::FoundWriter writer;
  writer.topic = "stillhand/other";
  writer.type = "stillhand_msgs::Sensed";
  EXPECT_FALSE(sut.step(writer, {0, 1, 0, 0, bytes}));
  writer.topic = "stillhand/sensed";
  EXPECT_TRUE(sut.step(writer, {0, 1, 0, 0, bytes}));
  EXPECT_FALSE(sut.step(writer, {0, 2, 0, 0, std::span(bytes).first(10)}));
}

TEST(FieldTriggerTest, EveryOtherTextIsRefused) {
  for (const char* bad : {"", "stillhand/sensed", "stillhand/sensed>5", "stillhand/sensed.>5",
                          ".x>5", "stillhand/sensed.accel_y_m_s2=5", "stillhand/sensed.theta_rad>",
                          "stillhand/sensed.theta_rad>nan", "stillhand/sensed.theta_rad>5x",
                          "stillhand/sensed.no_such_field>5", "stillhand/event.text>5"}) {
    EXPECT_THROW(FieldTrigger{bad}, ConfigError) << bad;
  }
  EXPECT_EQ(FieldTrigger("a.b/c.d>1").topic(), "a.b/c");
}

}  // namespace
}  // namespace stillhand::record

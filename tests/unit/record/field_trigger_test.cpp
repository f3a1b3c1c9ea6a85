// SPDX-License-Identifier: Apache-2.0
#include "apps/record/field_trigger.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/idl_text.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::record::field_trigger_test {
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
  const auto bytes = to_cdr(message);
  runtime::FoundWriter writer;
  writer.topic = "stillhand/other";
  writer.type = "stillhand_msgs::Sensed";
  EXPECT_FALSE(sut.step(writer, {0, 1, 0, 0, 0, bytes}));
  writer.topic = "stillhand/sensed";
  EXPECT_TRUE(sut.step(writer, {0, 1, 0, 0, 0, bytes}));
  EXPECT_FALSE(sut.step(writer, {0, 2, 0, 0, 0, std::span(bytes).first(10)}));
}

/// A sample of a topic that the catalogue lacks, as its type says.
template <typename Message>
bool step(FieldTrigger& sut, const std::string& topic, const std::string& type,
          const Message& message) {
  const auto bytes = to_cdr(message);
  runtime::FoundWriter writer;
  writer.topic = topic;
  writer.type = type;
  writer.idl = topics::idl_of(type);
  return sut.step(writer, {0, 1, 0, 0, 0, bytes});
}

// A lost field is no number; the sample after it crosses again.
TEST(FieldTriggerTest, AfterANaNTheNextSampleBeyondTheThresholdFires) {
  FieldTrigger sut("stillhand/sensed.|accel_y_m_s2|>5");
  EXPECT_TRUE(sut.step(6.0));
  EXPECT_FALSE(sut.step(std::nan("")));
  EXPECT_TRUE(sut.step(-6.0));
  EXPECT_FALSE(sut.step(INFINITY));
}

TEST(FieldTriggerTest, AFieldBelowItsThresholdFromTheFirstSampleOnFiresThere) {
  FieldTrigger sut("stillhand/sensed.force_n<1e-3");
  EXPECT_TRUE(sut.step(0.0));
  EXPECT_FALSE(sut.step(-INFINITY));
}

TEST(FieldTriggerTest, WholeNumbersAreReadWithTheirSign) {
  stillhand_msgs::MotorCommand message;
  message.model(-1);
  message.tick(1'000'000);
  FieldTrigger model("bench/motor.model<0");
  FieldTrigger tick("bench/motor.tick>999999");
  FieldTrigger flags("bench/motor.flags>2147483647");
  const std::string type = "stillhand_msgs::MotorCommand";
  EXPECT_TRUE(step(model, "bench/motor", type, message));
  EXPECT_TRUE(step(tick, "bench/motor", type, message));
  EXPECT_FALSE(step(flags, "bench/motor", type, message));
  message.flags(1u << 31);
  EXPECT_TRUE(step(flags, "bench/motor", type, message));
}

TEST(FieldTriggerTest, AFieldThatTheFirstSamplesTypeLacksNeverFires) {
  FieldTrigger sut("bench/motor.no_such_field>-1");
  stillhand_msgs::MotorCommand message;
  message.rig(7);  // the first field: above the threshold
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(step(sut, "bench/motor", "stillhand_msgs::MotorCommand", message)) << i;
  }
}

TEST(FieldTriggerTest, AForeignTopicIsReadByItsOwnDefinitionAndWithoutOneItNeverFires) {
  runtime::FoundWriter writer;
  writer.topic = "tank/level";
  writer.type = "tank::Level";
  const std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0},
                                     std::byte{9}, std::byte{0}, std::byte{0}, std::byte{0}};
  for (const std::string_view unknown : {"", "struct {{{", "struct Level { long other; };"}) {
    FieldTrigger sut("tank/level.height_mm>5");
    writer.idl = unknown;
    EXPECT_FALSE(sut.step(writer, {0, 1, 0, 0, 0, bytes})) << unknown;
  }
  FieldTrigger sut("tank/level.height_mm>5");
  writer.idl = "module tank { struct Level { long height_mm; }; };";
  EXPECT_TRUE(sut.step(writer, {0, 1, 0, 0, 0, bytes}));
}

TEST(FieldTriggerTest, ACopyTriggersOnItsOwn) {
  FieldTrigger sut("stillhand/sensed.force_n>5");
  EXPECT_TRUE(sut.step(6.0));
  FieldTrigger copy = sut;
  EXPECT_FALSE(copy.step(7.0));
  EXPECT_FALSE(copy.step(0.0));
  EXPECT_FALSE(sut.step(8.0));
  EXPECT_TRUE(copy.step(6.0));
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
}  // namespace stillhand::record::field_trigger_test

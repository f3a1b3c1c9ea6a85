// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/ros2msg.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "services/core/contract/config_error.hpp"
#include "services/core/recording/messages/message_columns.hpp"
#include "services/core/recording/messages/schema_types.hpp"
#include "tests/support/cdr_bytes.hpp"
#include "tests/support/refusal.hpp"

namespace stillhand::recording::ros2msg_test {
namespace {

using testing::HasSubstr;

std::string error_of(const std::string& text) {
  return support::refusal([&] { (void)parse_ros2msg(text, "pkg/msg/M", "bag"); });
}

std::vector<std::string> names_of(const MessageColumns& columns) {
  std::vector<std::string> names;
  for (const MessageColumn& column : columns.columns()) names.push_back(column.name);
  return names;
}

TEST(Ros2MsgTest, AnImuMessageIsDecodedByItsDefinition) {
  const IdlSchema sut =
      parse_ros2msg(tests::imu_definition(), "sensor_msgs/msg/Imu", "bag, schema 1");
  const IdlStruct* type = sut.find("sensor_msgs/msg/Imu");
  ASSERT_NE(type, nullptr);
  MessageColumns columns(sut, *type);
  ASSERT_EQ(columns.trouble(), "");
  columns.settle();
  tests::CdrBytes message;
  message.put(std::int32_t{7}).put(std::uint32_t{250}).text("imu");
  for (int i = 0; i < 4 + 9 + 3 + 9 + 3 + 9; ++i) message.put(0.5 + i);
  std::vector<Cell> row;
  ASSERT_TRUE(columns.read(message.bytes(), row));
  const std::vector<std::string> names = names_of(columns);
  const auto value = [&](const std::string& name) {
    const auto at = std::ranges::find(names, name) - names.begin();
    return row[static_cast<std::size_t>(at)];
  };
  EXPECT_EQ(std::get<std::int64_t>(value("header.stamp.sec")), 7);
  EXPECT_EQ(std::get<std::uint64_t>(value("header.stamp.nanosec")), 250u);
  EXPECT_EQ(std::get<std::string_view>(value("header.frame_id")), "imu");
  EXPECT_EQ(std::get<double>(value("orientation.x")), 0.5);
  EXPECT_EQ(std::get<double>(value("orientation_covariance.8")), 12.5);
  EXPECT_EQ(std::get<double>(value("angular_velocity.z")), 15.5);
  EXPECT_EQ(std::get<double>(value("linear_acceleration.y")), 26.5);
}

TEST(Ros2MsgTest, EveryKindOfMemberIsRead) {
  const IdlSchema sut = parse_ros2msg(
      "uint8 OFF=0  # a constant\n"
      "string NAME = \"a # b\"\n"
      "bool on\nbyte raw\nchar letter\nint8 a\nuint16 b\nint64 c\nfloat32 d # [N] grip\n"
      "string<=10 label \"it's\" # a default\n"
      "int16[] free\nfloat64[<=3] few\nuint32[2] two\nInner inner\nother/Empty empty\n"
      "===\nMSG: pkg/Inner\nbuiltin_interfaces/Time t\n===\nMSG: other/Empty\n",
      "pkg/msg/M", "bag");
  MessageColumns columns(sut, *sut.find("pkg::msg::M"));
  tests::CdrBytes message;
  message.put(std::uint8_t{1}).put(std::uint8_t{2}).put(std::uint8_t{'c'}).put(std::int8_t{-4});
  message.put(std::uint16_t{5}).put(std::int64_t{-6}).put(7.5F).text("x");
  message.put(std::uint32_t{2}).put(std::int16_t{8}).put(std::int16_t{-9});
  message.put(std::uint32_t{1}).put(10.5).put(std::uint32_t{11}).put(std::uint32_t{12});
  message.put(std::int32_t{13}).put(std::uint32_t{14}).put(std::uint8_t{0});
  ASSERT_TRUE(columns.learn(message.bytes()));
  columns.settle();
  EXPECT_THAT(names_of(columns),
              testing::ElementsAre("on", "raw", "letter", "a", "b", "c", "d", "label", "free.count",
                                   "free.0", "free.1", "few.count", "few.0", "two.0", "two.1",
                                   "inner.t.sec", "inner.t.nanosec",
                                   "empty.structure_needs_at_least_one_member"));
  std::vector<Cell> row;
  ASSERT_TRUE(columns.read(message.bytes(), row));
  EXPECT_EQ(std::get<std::uint64_t>(row[2]), std::uint64_t{'c'});
  EXPECT_EQ(std::get<std::int64_t>(row[5]), -6);
  EXPECT_EQ(std::get<double>(row[6]), 7.5);
  EXPECT_EQ(columns.columns()[6].unit, "N");
  EXPECT_EQ(std::get<std::int64_t>(row[10]), -9);
  EXPECT_EQ(std::get<double>(row[12]), 10.5);
  EXPECT_EQ(std::get<std::uint64_t>(row[14]), 12u);
  EXPECT_EQ(std::get<std::uint64_t>(row[16]), 14u);
}

TEST(Ros2MsgTest, SaysWhatIsWrongWithItsLine) {
  EXPECT_THAT(error_of("float64 x\nfloat64\n"), HasSubstr("bag:2: got 'float64', want a type and"));
  EXPECT_THAT(error_of("Missing x\n"), HasSubstr("bag:1: got the type pkg/Missing, want its"));
  EXPECT_THAT(error_of("float64[0] x\n"), HasSubstr("got 'float64[0]', want a length"));
  EXPECT_THAT(error_of("float64[2 x\n"), HasSubstr("want a closing ]"));
  EXPECT_THAT(error_of("M m\n"), HasSubstr("the type pkg/M within itself"));
}

TEST(Ros2MsgTest, TheSchemaRecordOfAFileChoosesTheParser) {
  const auto schema = [](const char* encoding, const std::string& text) {
    Schema out{1, "a/B", encoding, {}};
    for (const char c : text) out.bytes.push_back(static_cast<std::byte>(c));
    return out;
  };
  EXPECT_NE(parse_schema(schema("ros2msg", "float64 x"), "s").find("a/B"), nullptr);
  EXPECT_NE(
      parse_schema(schema("omgidl", "module a { struct B { double x; }; };"), "s").find("a/B"),
      nullptr);
  EXPECT_THROW((void)parse_schema(schema("omgidl", "struct C { double x; };"), "s"), ConfigError);
  EXPECT_THROW((void)parse_schema(schema("protobuf", ""), "s"), ConfigError);
}

}  // namespace
}  // namespace stillhand::recording::ros2msg_test

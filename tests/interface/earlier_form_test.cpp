// SPDX-License-Identifier: Apache-2.0
// Messages of recordings from before fields were added, written by hand, field by field.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"
namespace stillhand {
namespace {

template <typename... Fields>
std::vector<std::byte> bytes_of(const Fields&... fields) {
  std::vector<char> room(512);
  eprosima::fastcdr::FastBuffer buffer(room.data(), room.size());
  fast_cdr::PlainCdr cdr(buffer);
  cdr.serialize_encapsulation();
  (cdr << ... << fields);
  const auto* begin = reinterpret_cast<const std::byte*>(room.data());
  return {begin, begin + cdr.length()};
}

std::vector<std::byte> filled_up(std::vector<std::byte> bytes) {
  bytes.resize((bytes.size() + 3) / 4 * 4);
  return bytes;
}

using U32 = std::uint32_t;
using I32 = std::int32_t;
using I64 = std::int64_t;

TEST(EarlierFormTest, AMotorCommandWithoutAMitigationIsRead) {
  const auto old =
      bytes_of(U32{1}, I64{2}, I64{3}, I64{4}, 5.5, 6.5, 7.5, 8.5, I32{9}, true, false, U32{10});
  stillhand_msgs::MotorCommand message;
  message.taken_off_rad(1.0);
  ASSERT_TRUE(from_cdr(old, message));
  EXPECT_EQ(std::tuple(message.tick(), message.force_n(), message.phase_weight(), message.model()),
            std::tuple(2, 5.5, 8.5, 9));
  EXPECT_EQ(std::tuple(message.enabled(), message.permitted(), message.flags()),
            std::tuple(true, false, 10u));
  EXPECT_EQ(std::tuple(message.taken_off_rad(), message.mitigated_trial()), std::tuple(0.0, 0));
  // A message that was cut off is none.
  for (const std::size_t size : {old.size() - 1, old.size() - 4, old.size() + 4}) {
    auto cut = old;
    cut.resize(size);
    EXPECT_FALSE(from_cdr(cut, message)) << size;
  }
}

TEST(EarlierFormTest, ATrackingSampleWithoutACommandIsRead) {
  const auto old = bytes_of(U32{1}, I64{2}, I64{3}, 4.5, 5.5, true, I32{6}, U32{7});
  stillhand_msgs::TrackingSample message;
  ASSERT_TRUE(from_cdr(old, message));
  EXPECT_EQ(std::tuple(message.cursor_m(), message.inside(), message.trial(), message.flags()),
            std::tuple(5.5, true, 6, 7u));
  EXPECT_EQ(message.command_tick(), 0);
}

TEST(EarlierFormTest, AnAssignmentWithoutAMitigationIsRead) {
  const auto old =
      bytes_of(U32{1}, I64{2}, I32{3}, U32{1}, 4.5, 5.5, I32{6}, 7.5, 8.5, std::uint64_t{9}, true);
  for (const auto& bytes : {old, filled_up(old)}) {
    stillhand_msgs::TrialAssignment message;
    ASSERT_TRUE(from_cdr(bytes, message)) << bytes.size();
    EXPECT_EQ(std::tuple(message.trial(), message.rms_m_s2(), message.motion_seed()),
              std::tuple(3, 7.5, 9u));
    EXPECT_TRUE(message.cancellation());
    EXPECT_STREQ(message.mitigation().c_str(), "");
    EXPECT_TRUE(message.parts().empty());
  }
}

// Empty sequences are a length of 0; the map of the output has two numbers before its own.
TEST(EarlierFormTest, AControlModelWithoutElementsWithMemoryIsRead) {
  const std::vector<double> numbers{1.0, -0.5};
  const auto old = bytes_of(U32{1}, I64{2}, I32{1003}, I64{4}, 1000.0, numbers, U32{0}, U32{0}, 0.0,
                            0.0, U32{0}, U32{0}, U32{0}, true, 5.5, 6.5, 7.5, 8.5);
  stillhand_msgs::AugmentedModel message;
  message.hysteresis().resize(2);
  ASSERT_TRUE(from_cdr(old, message));
  EXPECT_EQ(std::tuple(message.model(), message.from_tick(), message.rate_hz()),
            std::tuple(1003, 4, 1000.0));
  EXPECT_EQ(message.denominator(), numbers);
  EXPECT_EQ(std::tuple(message.adapts(), message.hand_mass_kg(), message.hand_lever_m()),
            std::tuple(true, 5.5, 8.5));
  EXPECT_TRUE(message.hysteresis().empty());
  EXPECT_EQ(message.spring_ticks(), 0);
  auto cut = old;
  cut.resize(old.size() - 8);
  EXPECT_FALSE(from_cdr(cut, message));
}

TEST(EarlierFormTest, AModelOfAForceIsRead) {
  const std::vector<double> numerator{0.5, 1.5};
  const auto old =
      bytes_of(U32{1}, I64{2}, I32{3}, I64{4}, I32{5}, 50.0, numerator, numerator, 1000.0,
               numerator, numerator, 6.5, 7.5, 8.5, true, std::string("all is well"));
  for (const auto& bytes : {old, filled_up(old)}) {
    stillhand_msgs::FeedthroughModel message;
    ASSERT_TRUE(from_cdr(bytes, message)) << bytes.size();
    EXPECT_EQ(message.control_numerator(), numerator);
    EXPECT_STREQ(message.text().c_str(), "all is well");
    EXPECT_TRUE(message.usable());
    EXPECT_FALSE(message.to_position());
  }
}

TEST(EarlierFormTest, AnEventWithoutACodeIsRead) {
  for (const std::string text : {"", "a", "ab", "abc", "abcd"}) {
    const auto old =
        bytes_of(U32{1}, I64{2}, I64{3}, static_cast<U32>(stillhand_msgs::EVENT_INTERLOCK_OPENED),
                 std::string("rig"), std::string(), std::string(), 4.5, text);
    for (const auto& bytes : {old, filled_up(old)}) {
      stillhand_msgs::Event message;
      message.code(stillhand_msgs::CODE_EMERGENCY_STOP);
      ASSERT_TRUE(from_cdr(bytes, message)) << text;
      EXPECT_EQ(std::tuple(message.tick(), message.by_us()), std::tuple(2, 4.5));
      EXPECT_STREQ(message.text().c_str(), text.c_str());
      EXPECT_EQ(message.code(), stillhand_msgs::CODE_NONE);
    }
  }
}

}  // namespace
}  // namespace stillhand

// SPDX-License-Identifier: Apache-2.0
// The recorder keeps bytes and the replay writes them: nothing of a message may change on the way,
// and no bytes from the network may do harm.
#include "services/runtime/bus/serialized_type.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/runtime/bus/bus.hpp"
#include "services/runtime/bus/type_tag.hpp"

namespace stillhand::runtime {
namespace {

using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::SerializedPayload_t;

template <typename Message>
eprosima::fastdds::dds::TypeSupport support_of() {
  return type_tag<Message>().support;
}

TEST(FindTypeTest, EveryTypeOfBothTablesIsFoundUnderItsNameAndNoOther) {
  const auto check = [](const topics::Topic* row) {
    const TypeTag* tag = find_type(row->type);
    ASSERT_NE(tag, nullptr) << row->type;
    EXPECT_EQ(tag->support.get_type_name(), row->type);
    const std::string name(row->type);
    for (const std::string& other :
         {name + " ", name.substr(1), name.substr(0, name.size() - 1), name + "_"}) {
      EXPECT_EQ(find_type(other), nullptr) << other;
    }
  };
  for (const topics::Topic* row : topics::kCatalogue) check(row);
  for (const topics::Topic* row : topics::kRemoteControl) check(row);
  EXPECT_EQ(find_type(""), nullptr);
  EXPECT_EQ(find_type("Sensed"), nullptr);
}

// The bits of every double, NaN and the smallest number included.
TEST(ToBytesTest, AMessageComesBackBitForBit) {
  std::mt19937_64 random(20261123);
  const auto any_double = [&] {
    const std::uint64_t bits = random();
    double value = 0;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  };
  const auto support = support_of<stillhand_msgs::Sensed>();
  for (int turn = 0; turn < 200; ++turn) {
    stillhand_msgs::Sensed message;
    message.rig(static_cast<std::uint32_t>(random()));
    message.tick(static_cast<std::int64_t>(random()));
    message.accel_x_m_s2(turn == 0 ? std::nan("") : any_double());
    message.accel_y_m_s2(turn == 0 ? -0.0 : any_double());
    message.force_n(turn == 0 ? std::numeric_limits<double>::denorm_min() : any_double());
    message.theta_rad(turn == 0 ? -INFINITY : any_double());
    message.flags(static_cast<std::uint32_t>(random()));
    const SerializedSample bytes = to_bytes(support, &message);
    stillhand_msgs::Sensed back;
    ASSERT_TRUE(from_bytes(support, bytes, &back));
    EXPECT_EQ(back.tick(), message.tick());
    EXPECT_EQ(back.flags(), message.flags());
    ASSERT_EQ(to_bytes(support, &back), bytes) << "turn " << turn;
  }
}

stillhand_msgs::Event event_of(const std::string& text) {
  stillhand_msgs::Event event;
  event.rig(3);
  event.source("rig");
  event.topic("stillhand/sensed");
  event.text(text);
  return event;
}

// Every field follows the one before, so a message that ends early lacks at least one byte of its
// last fields: a text, and the code that a message of before did not have.
TEST(FromBytesTest, AMessageThatEndsEarlyIsRefusedAtEveryLength) {
  const auto support = support_of<stillhand_msgs::Event>();
  auto event = event_of("two ticks lost");
  const SerializedSample whole = to_bytes(support, &event);
  // A text ends in a zero byte, which a reader may leave out, and CDR may pad to four bytes.
  constexpr std::size_t kTail = 4 + sizeof(stillhand_msgs::EventCode);
  for (std::size_t size = 1; size + kTail < whole.size(); ++size) {
    const SerializedSample cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
    stillhand_msgs::Event back;
    EXPECT_FALSE(from_bytes(support, cut, &back)) << size << " of " << whole.size();
  }
  stillhand_msgs::Event back;
  EXPECT_TRUE(from_bytes(support, whole, &back));
}

TEST(FromBytesTest, ALengthBeyondTheMessageIsRefused) {
  const auto support = support_of<stillhand_msgs::Event>();
  auto event = event_of("x");
  const SerializedSample whole = to_bytes(support, &event);
  // Header 4, rig 4, padding to 8, tick 8, stamp 8, kind 4: then the length of `source`.
  constexpr std::size_t kLength = 4 + 4 + 4 + 8 + 8 + 4;
  std::uint32_t length = 0;
  std::memcpy(&length, whole.data() + kLength, sizeof(length));
  ASSERT_EQ(length, 4u);  // "rig" and its zero
  for (const std::uint32_t hostile : {0xffffffffu, 0x7fffffffu, 0x10000u}) {
    SerializedSample bytes = whole;
    std::memcpy(bytes.data() + kLength, &hostile, sizeof(hostile));
    stillhand_msgs::Event back;
    EXPECT_FALSE(from_bytes(support, bytes, &back)) << hostile;
  }
}

// Whatever the answer is: no crash, no exception, no byte outside (the sanitizers look).
TEST(FromBytesTest, RandomBytesDoNoHarmToAnyType) {
  std::mt19937 random(20261123);
  for (const topics::Topic* row : topics::kCatalogue) {
    const TypeTag* tag = find_type(row->type);
    ASSERT_NE(tag, nullptr);
    auto support = tag->support;
    void* message = support->createData();
    for (int turn = 0; turn < 50; ++turn) {
      SerializedSample bytes(1 + random() % 200);
      for (std::byte& each : bytes) each = static_cast<std::byte>(random());
      if (bytes.size() >= 4) {
        std::fill_n(bytes.begin(), 4, std::byte{0});
        bytes[1] = std::byte{1};  // a header that is right
      }
      EXPECT_NO_THROW(from_bytes(support, bytes, message)) << row->type;
    }
    support->deleteData(message);
  }
}

TEST(SerializedTypeTest, HasNameAndKeyOfTheRealType) {
  const auto real = support_of<stillhand_msgs::ServiceStatus>();
  SerializedType sut(real);
  EXPECT_STREQ(sut.getName(), "stillhand_msgs::ServiceStatus");
  EXPECT_TRUE(sut.m_isGetKeyDefined);
  for (const char* service : {"rig", "identification", ""}) {
    stillhand_msgs::ServiceStatus status;
    status.rig(3);
    status.service(service);
    SerializedSample sample = to_bytes(real, &status);
    InstanceHandle_t want, got;
    ASSERT_TRUE(real->getKey(&status, &want, false));
    ASSERT_TRUE(sut.getKey(&sample, &got, false));
    EXPECT_EQ(got, want) << service;
  }
}

TEST(SerializedTypeTest, BytesThatAreNoMessageHaveNoKey) {
  SerializedType sut(support_of<stillhand_msgs::ServiceStatus>());
  InstanceHandle_t handle;
  SerializedSample sample(3, std::byte{0xff});
  EXPECT_FALSE(sut.getKey(&sample, &handle, false));
}

TEST(SerializedTypeTest, KeepsTheBytesAsTheyCame) {
  SerializedType sut(support_of<stillhand_msgs::Sensed>());
  auto* sample = static_cast<SerializedSample*>(sut.createData());
  SerializedPayload_t came(5);
  came.length = 5;
  std::memcpy(came.data, "\xff\0z\n\x01", 5);
  ASSERT_TRUE(sut.deserialize(&came, sample));
  EXPECT_EQ(sample->size(), 5u);
  EXPECT_EQ(sut.getSerializedSizeProvider(sample)(), 5u);
  SerializedPayload_t goes(5);
  ASSERT_TRUE(sut.serialize(sample, &goes));
  ASSERT_EQ(goes.length, 5u);
  EXPECT_EQ(std::memcmp(goes.data, came.data, 5), 0);
  SerializedPayload_t small(4);
  EXPECT_FALSE(sut.serialize(sample, &small));
  sut.deleteData(sample);
}

}  // namespace
}  // namespace stillhand::runtime

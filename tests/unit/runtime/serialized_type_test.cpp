// SPDX-License-Identifier: Apache-2.0
// The recorder keeps bytes and the replay writes them: nothing of a message may change on the way,
// and no bytes from the network may do harm.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "fast_dds/types.hpp"
#include "idl/control_loop.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime::serialized_type_test {
namespace {

template <typename Message>
edds::TypeSupport support_of() {
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

// Fast CDR 2 alone takes an end between two fields for the end of the message.
TEST(FromBytesTest, ASampleOfTheLoopThatEndsEarlyIsRefusedAtEveryLength) {
  const auto support = support_of<stillhand_msgs::Sensed>();
  stillhand_msgs::Sensed message;
  const SerializedSample whole = to_bytes(support, &message);
  for (std::size_t size = 1; size < whole.size(); ++size) {
    EXPECT_FALSE(from_bytes(support, std::span(whole).first(size), &message)) << size;
  }
  EXPECT_TRUE(from_bytes(support, whole, &message));
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
    const auto message = message_of(*tag->support);
    for (int turn = 0; turn < 50; ++turn) {
      SerializedSample bytes(1 + random() % 200);
      for (std::byte& each : bytes) each = static_cast<std::byte>(random());
      if (bytes.size() >= 4) {
        std::fill_n(bytes.begin(), 4, std::byte{0});
        bytes[1] = std::byte{1};  // a header that is right
      }
      EXPECT_NO_THROW(from_bytes(tag->support, bytes, message.get())) << row->type;
    }
  }
}

TEST(SerializedTypeTest, HasNameAndKeyOfTheRealType) {
  const auto real = support_of<stillhand_msgs::ServiceStatus>();
  SerializedType sut(real);
  EXPECT_EQ(name_of(sut), "stillhand_msgs::ServiceStatus");
  EXPECT_TRUE(has_key(sut));
  for (const char* service : {"rig", "identification", ""}) {
    stillhand_msgs::ServiceStatus status;
    status.rig(3);
    status.service(service);
    SerializedSample sample = to_bytes(real, &status);
    ertps::InstanceHandle_t want, got;
    ASSERT_TRUE(key_of(*real, &status, want));
    ASSERT_TRUE(key_of(sut, &sample, got));
    EXPECT_EQ(got, want) << service;
  }
}

TEST(SerializedTypeTest, BytesThatAreNoMessageHaveNoKey) {
  SerializedType sut(support_of<stillhand_msgs::ServiceStatus>());
  ertps::InstanceHandle_t handle;
  SerializedSample sample(3, std::byte{0xff});
  EXPECT_FALSE(key_of(sut, &sample, handle));
}

TEST(SerializedTypeTest, KeepsTheBytesAsTheyCame) {
  SerializedType sut(support_of<stillhand_msgs::Sensed>());
  const auto sample = std::static_pointer_cast<SerializedSample>(message_of(sut));
  ertps::SerializedPayload_t came(5);
  came.length = 5;
  std::memcpy(came.data, "\xff\0z\n\x01", 5);
  ASSERT_TRUE(deserialize(sut, came, sample.get()));
  EXPECT_EQ(sample->size(), 5u);
  EXPECT_EQ(size_of(sut, sample.get()), 5u);
  ertps::SerializedPayload_t goes(5);
  ASSERT_TRUE(serialize(sut, sample.get(), goes));
  ASSERT_EQ(goes.length, 5u);
  EXPECT_EQ(std::memcmp(goes.data, came.data, 5), 0);
  ertps::SerializedPayload_t small(4);
  EXPECT_FALSE(serialize(sut, sample.get(), small));
}

}  // namespace
}  // namespace stillhand::runtime::serialized_type_test

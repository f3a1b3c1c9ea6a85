// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/message_columns.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <initializer_list>
#include <random>

namespace stillhand::recording::message_columns_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<std::byte>;

constexpr const char* kIdl = R"(
module lab {
  enum Phase { IDLE, PEGGED };
  struct Point {
    float x;  /* [m] */
    string name;
  };
  struct Message {
    boolean on;                   // [-]
    double force_n;               // [N] of the hand
    Phase phase;                  // [-]
    octet raw[2];
    sequence<Point, 4> points;    // [-]
    sequence<long long> ticks;    // [ns] of each
    short last;
  };
};
)";

// Writes CDR by its rules and nothing else, so that the decoder is no oracle for itself.
class CdrText {
 public:
  explicit CdrText(std::uint8_t kind = 1) : bytes_{std::byte{0}, std::byte{kind}, {}, {}} {}
  template <typename T>
  CdrText& put(T value) {
    const std::size_t most = bytes_[1] >= std::byte{6} ? 4 : 8;
    while ((bytes_.size() - 4) % std::min(sizeof(T), most) != 0) bytes_.push_back({});
    std::array<std::byte, sizeof(T)> raw{};
    std::memcpy(raw.data(), &value, sizeof(T));
    if ((bytes_[1] & std::byte{1}) == std::byte{0}) std::ranges::reverse(raw);
    bytes_.insert(bytes_.end(), raw.begin(), raw.end());
    return *this;
  }
  CdrText& put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size() + 1));
    for (const char c : text) bytes_.push_back(static_cast<std::byte>(c));
    bytes_.push_back({});
    return *this;
  }
  [[nodiscard]] const Bytes& bytes() const { return bytes_; }

 private:
  Bytes bytes_;
};

Bytes message(std::uint8_t kind, std::uint32_t points) {
  CdrText cdr(kind);
  const bool head = kind >= 6;
  cdr.put(std::uint8_t{1})
      .put(-3.25)
      .put(std::int32_t{1})
      .put(std::uint8_t{7})
      .put(std::uint8_t{9});
  if (head) cdr.put(std::uint32_t{0});  // its value is not needed
  cdr.put(points);
  for (std::uint32_t i = 0; i < points; ++i) {
    cdr.put(0.5f + static_cast<float>(i)).put_text(i == 0 ? "left" : "");
  }
  cdr.put(std::uint32_t{1}).put(std::int64_t{1'700'000'000'123'456'789}).put(std::int16_t{-2});
  return cdr.bytes();
}

std::vector<std::string> names_of(const MessageColumns& columns) {
  std::vector<std::string> names;
  for (const MessageColumn& column : columns.columns()) {
    names.push_back(column.name + (column.unit.empty() ? "" : " [" + column.unit + "]"));
  }
  return names;
}

class MessageColumnsTest : public testing::Test {
 protected:
  const IdlSchema schema_ = parse_idl(kIdl, "test");
  MessageColumns sut_{schema_, *schema_.find("lab::Message")};
};

TEST_F(MessageColumnsTest, AMessageBecomesARow) {
  // 0: plain CDR, big-endian; 1: little; 6 and 7: XCDR2.
  for (const std::uint8_t kind : std::initializer_list<std::uint8_t>{0, 1, 6, 7}) {
    MessageColumns sut(schema_, *schema_.find("lab::Message"));
    ASSERT_EQ(sut.trouble(), "");
    EXPECT_TRUE(sut.has_lists());
    const Bytes bytes = message(kind, 1);
    ASSERT_TRUE(sut.learn(bytes));
    sut.settle();
    EXPECT_THAT(names_of(sut),
                ElementsAre("on [-]", "force_n [N]", "phase [-]", "phase.name [-]", "raw.0",
                            "raw.1", "points.count [-]", "points.0.x [m]", "points.0.name",
                            "ticks.count [-]", "ticks.0 [ns]", "last"));
    std::vector<Cell> row;
    ASSERT_TRUE(sut.read(bytes, row));
    using U = std::uint64_t;
    using I = std::int64_t;
    EXPECT_THAT(row, ElementsAre(Cell(U{1}), Cell(-3.25), Cell(I{1}), Cell("PEGGED"), Cell(U{7}),
                                 Cell(U{9}), Cell(U{1}), Cell(0.5), Cell("left"), Cell(U{1}),
                                 Cell(I{1'700'000'000'123'456'789}), Cell(I{-2})))
        << "encapsulation " << int{kind};
  }
}

TEST_F(MessageColumnsTest, TheLongestListDecidesAndShorterOnesLeaveCellsEmpty) {
  for (const std::uint32_t points : {1u, 3u, 0u}) ASSERT_TRUE(sut_.learn(message(1, points)));
  sut_.settle();
  EXPECT_EQ(sut_.columns().size(), 12u + 2 * 2u);
  std::vector<Cell> row;
  ASSERT_TRUE(sut_.read(message(1, 1), row));
  EXPECT_EQ(row[7], Cell(0.5));
  EXPECT_EQ(row[9], Cell());
  EXPECT_EQ(row[12], Cell());
  ASSERT_TRUE(sut_.read(message(1, 3), row));
  EXPECT_EQ(row[11], Cell(2.5));
  EXPECT_FALSE(sut_.read(message(1, 4), row)) << "longer than learned";
}

TEST_F(MessageColumnsTest, ABytesThatAreNoSuchMessageAreRefusedAtEveryLength) {
  const Bytes whole = message(1, 2);
  ASSERT_TRUE(sut_.learn(whole));
  sut_.settle();
  std::vector<Cell> row;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    const std::span<const std::byte> cut(whole.data(), length);
    EXPECT_FALSE(sut_.learn(cut)) << length;
    EXPECT_FALSE(sut_.read(cut, row)) << length;
  }
  for (const std::uint8_t kind : std::initializer_list<std::uint8_t>{
           2, 3, 8, 9, 10, 200}) {  // parameter lists, delimited, nonsense
    Bytes other = whole;
    other[1] = std::byte{kind};
    EXPECT_FALSE(sut_.read(other, row)) << int{kind};
  }
}

TEST_F(MessageColumnsTest, RandomBytesNeitherCrashNorMakeManyColumns) {
  std::mt19937_64 random(5);
  std::vector<Cell> row;
  for (int round = 0; round < 20'000; ++round) {
    Bytes bytes = message(static_cast<std::uint8_t>(round % 2), 2);
    for (int i = 0; i < 3; ++i) {
      bytes[4 + random() % (bytes.size() - 4)] = static_cast<std::byte>(random());
    }
    MessageColumns sut(schema_, *schema_.find("lab::Message"));
    const bool learned = sut.learn(bytes);
    sut.settle();
    ASSERT_LE(sut.columns().size(), 4096u);
    ASSERT_EQ(learned && sut.trouble().empty(), sut.read(bytes, row)) << round;
  }
}

TEST(MessageColumnsLimitsTest, WhatCannotBeATableIsRefusedWithItsReason) {
  const auto trouble = [](const std::string& text, const char* type) {
    const IdlSchema schema = parse_idl(text, "test");
    return MessageColumns(schema, *schema.find(type)).trouble();
  };
  EXPECT_THAT(trouble("struct A { double picture[640][480]; };", "A"), HasSubstr("more than 4096"));
  EXPECT_THAT(trouble("struct E { }; struct A { E all[4000000000]; };", "A"),
              HasSubstr("more than 4096"));
  EXPECT_THAT(trouble("union U switch (long) { case 1: long x; }; struct A { U u; };", "A"),
              HasSubstr("'u' has a kind that is not decoded: union U"));
  EXPECT_THAT(trouble("struct A { @optional long x; };", "A"), HasSubstr("'x' is @optional"));
  EXPECT_THAT(trouble("@extensibility(MUTABLE) struct A { long x; };", "A"), HasSubstr("@mutable"));
  std::string chain = "struct A0 { long x; };";
  for (int i = 1; i < 1000; ++i) {
    chain += "struct A" + std::to_string(i) + " { A" + std::to_string(i - 1) + " a; };";
  }
  EXPECT_THAT(trouble(chain, "A999"), HasSubstr("nested deeper than 64"));
}

}  // namespace
}  // namespace stillhand::recording::message_columns_test

// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/event_window.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace stillhand::recording::event_window_test {
namespace {

/// Messages at the given times, each of `size` bytes.
MessageBatch batch(const std::vector<std::uint64_t>& times_ns, std::size_t size = 1) {
  MessageBatch made;
  const std::vector<std::byte> bytes(size);
  for (const std::uint64_t at_ns : times_ns)
    made.add({0, 0, at_ns, at_ns, static_cast<std::int64_t>(at_ns), 0, 0}, bytes);
  return made;
}

std::vector<std::uint64_t> times_of(EventWindow& sut) {
  std::vector<std::uint64_t> times;
  for (const MessageBatch& each : sut.take()) {
    for (const HeldMessage& message : each.messages) times.push_back(message.log_time_ns);
  }
  return times;
}

TEST(EventWindowTest, ItHoldsTheLastStretchAndForgetsWhatIsOlder) {
  EventWindow sut(100, 1000);
  for (std::uint64_t at_ns = 0; at_ns <= 500; at_ns += 50) sut.add(batch({at_ns}));
  EXPECT_EQ(times_of(sut), (std::vector<std::uint64_t>{400, 450, 500}));
  EXPECT_EQ(sut.crowded_out(), 0u);
}

TEST(EventWindowTest, AClockThatIsSetMovesNoMessageOut) {
  for (const std::uint64_t set_ns : {std::uint64_t{1'000'000}, std::uint64_t{10}}) {
    EventWindow sut(100, 1000);
    std::vector<std::uint64_t> wanted;
    for (std::int64_t at_ns = 0; at_ns <= 500; at_ns += 50) {
      // From 250 on, the system's clock stands elsewhere.
      const std::uint64_t log_ns =
          (at_ns < 250 ? 5000 : set_ns) + static_cast<std::uint64_t>(at_ns);
      MessageBatch one;
      one.add({0, 0, log_ns, log_ns, at_ns, 0, 0}, {});
      sut.add(std::move(one));
      if (at_ns >= 400) wanted.push_back(log_ns);
    }
    EXPECT_EQ(times_of(sut), wanted);
  }
}

TEST(EventWindowTest, ABatchStaysWhileItsNewestMessageIsYoungEnough) {
  EventWindow sut(100, 1000);
  sut.add(batch({0, 90}));
  sut.add(batch({190}));
  EXPECT_EQ(times_of(sut), (std::vector<std::uint64_t>{0, 90, 190}));
}

TEST(EventWindowTest, WhatWasTakenIsNotThereAgain) {
  EventWindow sut(100, 1000);
  sut.add(batch({1, 2, 3}));
  EXPECT_EQ(sut.held_messages(), 3u);
  EXPECT_EQ(times_of(sut).size(), 3u);
  EXPECT_EQ(sut.held_messages(), 0u);
  EXPECT_TRUE(times_of(sut).empty());
  sut.add(batch({4}));
  sut.add({});  // an empty batch changes nothing
  EXPECT_EQ(times_of(sut), (std::vector<std::uint64_t>{4}));
  sut.add({});
  EXPECT_EQ(sut.held_messages(), 0u);
}

TEST(EventWindowTest, WhatHasNoRoomLeavesAndIsCounted) {
  EventWindow sut(1000, 20);  // exactly two of them
  for (std::uint64_t at_ns = 1; at_ns <= 4; ++at_ns) sut.add(batch({at_ns}, 10));
  EXPECT_EQ(sut.crowded_out(), 2u);
  EXPECT_EQ(times_of(sut), (std::vector<std::uint64_t>{3, 4}));
}

TEST(EventWindowTest, TheNewestBatchStaysHoweverLargeItIs) {
  EventWindow sut(100, 10);
  sut.add(batch({1}, 8));
  sut.add(batch({2, 3}, 500));
  EXPECT_EQ(sut.held_messages(), 2u);
  EXPECT_EQ(sut.crowded_out(), 1u);
  EXPECT_EQ(times_of(sut), (std::vector<std::uint64_t>{2, 3}));
}

TEST(EventWindowTest, WithoutALackOfRoomItHoldsEveryMessageOfTheWindow) {
  std::mt19937_64 random(8);
  for (int round = 0; round < 100; ++round) {
    EventWindow sut(1000, SIZE_MAX);
    std::vector<std::uint64_t> added;
    std::uint64_t at_ns = 0;
    for (int i = 0; i < 50; ++i) {
      std::vector<std::uint64_t> times;
      for (std::uint64_t n = random() % 5; n > 0; --n) times.push_back(at_ns += random() % 200);
      sut.add(batch(times));
      added.insert(added.end(), times.begin(), times.end());
    }
    const std::uint64_t held = sut.held_messages();
    const auto times = times_of(sut);
    ASSERT_EQ(times.size(), held);
    ASSERT_EQ(sut.crowded_out(), 0u);
    // The newest of those that were added, in their order, and all of the last 1000 ns.
    ASSERT_TRUE(std::equal(times.rbegin(), times.rend(), added.rbegin()));
    const auto young =
        std::ranges::count_if(added, [&](std::uint64_t t) { return t + 1000 >= at_ns; });
    ASSERT_GE(times.size(), static_cast<std::size_t>(young));
  }
}

}  // namespace
}  // namespace stillhand::recording::event_window_test

// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/handover.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "tests/support/wait.hpp"

namespace stillhand::runtime::handover_test {
namespace {

// Counts its own kind, so that a leak or a double free shows without a sanitizer too.
struct Counted {
  explicit Counted(int number_in) : number(number_in) { ++alive; }
  ~Counted() { --alive; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;
  int number;
  static inline std::atomic<int> alive{0};
};

TEST(HandoverTest, GivesNothingBeforeTheFirst) {
  Handover<Counted> sut;
  EXPECT_EQ(sut.current(), nullptr);
}

TEST(HandoverTest, GivesEachPreparedOneInTurnAndFreesAll) {
  {
    Handover<Counted> sut;
    for (int i = 1; i <= 5; ++i) {
      sut.prepare([i] { return std::make_unique<Counted>(i); });
      ASSERT_TRUE(support::eventually([&] {
        const Counted* now = sut.current();
        return now != nullptr && now->number == i;
      })) << "number "
          << i;
    }
  }
  EXPECT_EQ(Counted::alive.load(), 0);
}

TEST(HandoverTest, KeepsTheOldOneWhenThereIsNoNewOne) {
  Handover<Counted> sut;
  sut.prepare([] { return std::make_unique<Counted>(7); });
  ASSERT_TRUE(support::eventually([&] { return sut.current() != nullptr; }));
  // One at a time, in turn: once the third is being made, what the second returned has been seen
  // to.
  std::atomic<bool> asked{false}, making{false}, go_on{false};
  sut.prepare([&]() -> std::unique_ptr<Counted> {
    asked = true;
    return nullptr;
  });
  ASSERT_TRUE(support::eventually([&] { return asked.load(); }));
  sut.prepare([&] {
    making = true;
    support::eventually([&] { return go_on.load(); });
    return std::make_unique<Counted>(8);
  });
  EXPECT_TRUE(support::eventually([&] { return making.load(); }));
  const Counted* kept = sut.current();
  EXPECT_TRUE(kept != nullptr && kept->number == 7);
  go_on = true;
  EXPECT_TRUE(support::eventually([&] { return sut.current()->number == 8; }));
}

TEST(HandoverTest, ARequestThatWasNotBegunIsReplacedByTheNext) {
  Handover<Counted> sut;
  std::atomic<bool> making{false}, go_on{false}, second_made{false};
  sut.prepare([&] {
    making = true;
    support::eventually([&] { return go_on.load(); });
    return std::make_unique<Counted>(1);
  });
  ASSERT_TRUE(support::eventually([&] { return making.load(); }));
  sut.prepare([&] {
    second_made = true;
    return std::make_unique<Counted>(2);
  });
  sut.prepare([] { return std::make_unique<Counted>(3); });
  go_on = true;
  EXPECT_TRUE(support::eventually([&] {
    const Counted* now = sut.current();
    return now != nullptr && now->number == 3;
  }));
  EXPECT_FALSE(second_made.load());
}

TEST(HandoverTest, OneThatIsTakenWhileTheNextIsMadeKeepsNothingAway) {
  Handover<Counted> sut;
  sut.prepare([] { return std::make_unique<Counted>(1); });
  ASSERT_TRUE(support::eventually([&] { return sut.current() != nullptr; }));
  std::atomic<bool> second{false}, making{false}, go_on{false};
  sut.prepare([&] {
    second = true;
    return std::make_unique<Counted>(2);
  });
  ASSERT_TRUE(support::eventually([&] { return second.load(); }));
  // The second is handed over before the third is begun, and taken while the third is made.
  sut.prepare([&] {
    making = true;
    support::eventually([&] { return go_on.load(); });
    return std::make_unique<Counted>(3);
  });
  ASSERT_TRUE(support::eventually([&] { return making.load(); }));
  EXPECT_EQ(sut.current()->number, 2);
  go_on = true;
  EXPECT_TRUE(support::eventually([&] { return sut.current()->number == 3; }));
}

// Neither a request that another replaces is freed by who asks, nor one that was followed: the
// thread that receives samples asks.
TEST(HandoverTest, WhoAsksFreesNothing) {
  struct Freed {
    explicit Freed(std::atomic<int>& count_in) : count(count_in), by(std::this_thread::get_id()) {}
    ~Freed() {
      if (std::this_thread::get_id() == by) ++count;
    }
    std::atomic<int>& count;
    std::thread::id by;
  };
  std::atomic<int> freed_by_asking{0};
  std::atomic<int> made{0};
  Handover<Counted> sut;
  constexpr int kRequests = 1000;
  for (int i = 1; i <= kRequests; ++i) {
    sut.prepare([i, &made, what = std::make_shared<Freed>(freed_by_asking)] {
      made = i;
      return std::make_unique<Counted>(i);
    });
    sut.current();
  }
  EXPECT_TRUE(support::eventually([&] { return made.load() == kRequests; }));
  EXPECT_TRUE(support::eventually([&] {
    const Counted* now = sut.current();
    return now != nullptr && now->number == kRequests;
  }));
  EXPECT_EQ(freed_by_asking.load(), 0);
}

TEST(HandoverTest, SeveralThreadsMayAsk) {
  constexpr int kEach = 300;
  {
    Handover<Counted> sut;
    std::atomic<int> asked{0};
    {
      std::vector<std::jthread> threads;
      threads.reserve(3);
      for (int thread = 0; thread < 3; ++thread) {
        threads.emplace_back([&] {
          for (int i = 0; i < kEach; ++i) {
            sut.prepare([] { return std::make_unique<Counted>(1); });
            ++asked;
          }
        });
      }
    }
    EXPECT_EQ(asked.load(), 3 * kEach);
    sut.prepare([] { return std::make_unique<Counted>(2); });
    EXPECT_TRUE(support::eventually([&] {
      const Counted* now = sut.current();
      return now != nullptr && now->number == 2;
    }));
  }
  EXPECT_EQ(Counted::alive.load(), 0);
}

// The control path holds the pointer for the length of a step: current() alone may change it.
TEST(HandoverTest, WhatWasTakenLivesUntilTheNextTake) {
  {
    Handover<Counted> sut;
    sut.prepare([] { return std::make_unique<Counted>(1); });
    ASSERT_TRUE(support::eventually([&] { return sut.current() != nullptr; }));
    const Counted* held = sut.current();
    std::atomic<int> made{1};
    for (int i = 2; i <= 6; ++i) {
      sut.prepare([i, &made] {
        made = i;
        return std::make_unique<Counted>(i);
      });
      ASSERT_TRUE(support::eventually([&] { return made.load() == i; }));
      EXPECT_EQ(held->number, 1);
    }
  }
  EXPECT_EQ(Counted::alive.load(), 0);
}

}  // namespace
}  // namespace stillhand::runtime::handover_test

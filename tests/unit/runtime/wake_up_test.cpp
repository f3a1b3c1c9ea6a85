// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/wake_up.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace stillhand::runtime::wake_up_test {
namespace {

constexpr std::int64_t kLong_ns = 60 * kNsPerSecond;  // a guard: a test that waits so long fails

TEST(WakeUpTest, APostWakesTheThreadThatWaits) {
  WakeUp sut;
  std::atomic<int> value{0};
  std::thread other([&] {
    for (int n = 1; n <= 1000; ++n) {
      value.store(n);
      sut.post();
    }
  });
  EXPECT_TRUE(sut.wait_until_ns(monotonic_ns() + kLong_ns, [&] { return value.load() == 1000; }));
  other.join();
}

TEST(WakeUpTest, TheLimitEndsTheWait) {
  WakeUp sut;
  const std::int64_t until_ns = monotonic_ns() + 2'000'000;
  EXPECT_FALSE(sut.wait_until_ns(until_ns, [] { return false; }));
  EXPECT_GE(monotonic_ns(), until_ns);
}

TEST(WakeUpTest, ALimitThatIsOverDoesNotWait) {
  WakeUp sut;
  int looked = 0;
  EXPECT_FALSE(sut.wait_until_ns(monotonic_ns() - 1, [&] { return ++looked > 1; }));
  EXPECT_TRUE(sut.wait_until_ns(monotonic_ns() - 1, [] { return true; }));
}

// Posts of values that nobody waited for are left over; they only make it look again.
TEST(WakeUpTest, PostsFromBeforeDoNotEndTheWait) {
  WakeUp sut;
  for (int n = 0; n < 1000; ++n) sut.post();
  int looked = 0;
  EXPECT_FALSE(sut.wait_until_ns(monotonic_ns() + 50'000'000, [&] { return ++looked, false; }));
  EXPECT_GE(looked, 1000);
}

TEST(WakeUpTest, ASenderWithoutAPauseDoesNotHoldIt) {
  WakeUp sut;
  std::atomic<bool> ends{false};
  std::thread flood([&] {
    while (!ends.load()) sut.post();
  });
  const std::int64_t until_ns = monotonic_ns() + 2'000'000;
  EXPECT_FALSE(sut.wait_until_ns(until_ns, [] { return false; }));
  ends.store(true);
  flood.join();
}

}  // namespace
}  // namespace stillhand::runtime::wake_up_test

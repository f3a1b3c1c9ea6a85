// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/run_jobs.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/refusal.hpp"

namespace stillhand::runtime::run_jobs_test {
namespace {

TEST(RunJobsTest, EveryIndexRunsOnceWhateverTheNumberOfThreads) {
  for (const unsigned threads : {1U, 3U, 200U}) {
    std::vector<std::atomic<int>> ran(100);
    EXPECT_TRUE(run_jobs(ran.size(), threads, [&](std::size_t i) { ++ran[i]; }));
    for (const auto& each : ran) EXPECT_EQ(each, 1);
  }
  EXPECT_TRUE(run_jobs(0, 2, [](std::size_t) { FAIL(); }));
}

TEST(RunJobsTest, WithOneThreadTheCallerRunsTheJobsInOrder) {
  std::vector<std::size_t> order;
  const auto caller = std::this_thread::get_id();
  run_jobs(5, 1, [&](std::size_t i) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(i);
  });
  EXPECT_EQ(order, (std::vector<std::size_t>{0, 1, 2, 3, 4}));
}

TEST(RunJobsTest, TheExceptionOfTheLowestIndexIsThrownAndNoFurtherJobStarts) {
  std::atomic<int> ran{0};
  const auto job = [&](std::size_t i) {
    ++ran;
    if (i >= 3) throw std::runtime_error("job " + std::to_string(i));
  };
  EXPECT_EQ(support::refusal<std::runtime_error>([&] { run_jobs(1000, 2, job); }), "job 3");
  EXPECT_LE(ran, 5);  // 0 to 3, and one that the other thread had begun
}

TEST(RunJobsTest, OnDoneCountsInTheCallersThreadAndMayStop) {
  const auto caller = std::this_thread::get_id();
  std::size_t last = 0;
  EXPECT_TRUE(run_jobs(
      20, 2, [](std::size_t) {},
      [&](std::size_t done) {
        EXPECT_EQ(std::this_thread::get_id(), caller);
        EXPECT_GE(done, last);
        last = done;
        return true;
      }));
}

TEST(RunJobsTest, AfterOnDoneSaidStopNoFurtherJobStarts) {
  std::atomic<bool> stopped{false};
  std::atomic<int> ran{0};
  EXPECT_FALSE(run_jobs(
      1000, 2,
      [&](std::size_t) {
        ++ran;
        while (!stopped) std::this_thread::yield();
      },
      [&](std::size_t) {
        stopped = true;
        return false;
      }));
  EXPECT_LT(ran, 1000);
}

}  // namespace
}  // namespace stillhand::runtime::run_jobs_test

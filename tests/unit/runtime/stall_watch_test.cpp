// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/stall_watch.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <csignal>
#include <iostream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include "services/system/process/clock.hpp"
#include "tests/support/wait.hpp"

namespace stillhand::runtime::stall_watch_test {
namespace {

constexpr std::int64_t kMs = 1'000'000;

/// An account at a time, all in ms but the counts.
ThreadAccount at(std::int64_t ms, std::int64_t ran, std::int64_t waited, std::int64_t pages = 0,
                 std::int64_t continued = 0) {
  return {ms * kMs, ran * kMs, waited * kMs, pages, continued};
}

/// Of a silence from 210 to 280 ms, with accounts at 100, 200 and 300 ms; the thread usually works
/// for a tenth of its time.
std::string why(const ThreadAccount& after, std::string_view call = {}) {
  return why_silent(210 * kMs, 280 * kMs, at(100, 10, 1), at(200, 20, 2), after, {}, call);
}

TEST(WhySilentTest, NamesWhatGrewBeyondItsUsualGrowth) {
  EXPECT_EQ(why(at(300, 23, 72)), "waited 70 ms for a processor");
  EXPECT_EQ(why(at(300, 93, 2)), "worked for 70 ms");
  EXPECT_EQ(why(at(300, 23, 2, 4)), "waited for 4 pages of memory from a disk");
  EXPECT_EQ(why(at(300, 23, 2, 0, 1)), "stopped by a signal");
  EXPECT_EQ(why(at(300, 23, 2, 1), "write()"), "blocked in write()");
  EXPECT_EQ(why(at(300, 93, 2), "write()"), "worked for 70 ms");
  EXPECT_EQ(why(at(300, 23, 2, 0, 1), "write()"), "stopped by a signal");
}

TEST(WhySilentTest, DoesNotGuess) {
  EXPECT_EQ(why(at(300, 23, 2)), "");   // asleep: it waited for somebody
  EXPECT_EQ(why(at(300, 50, 30)), "");  // a bit of everything
  // No account of before, or none of after.
  EXPECT_EQ(why_silent(210 * kMs, 280 * kMs, {}, {}, at(300, 23, 90)), "");
  EXPECT_EQ(why_silent(210 * kMs, 280 * kMs, {}, at(200, 20, 2), at(250, 23, 90)), "");
}

/// A thread that beats each millisecond until this ends, and the watch on it.
class Watched {
 public:
  Watched() : thread_([this] { work(); }) {
    for (int n = 0; n < 3; ++n) (void)after_a_while();  // a busy machine stops it, too
  }
  ~Watched() {
    ends_ = true;
    thread_.join();
  }
  /// It does this once, between two beats.
  void once(void (*what)()) { next_ = what; }
  std::optional<Stall> after_a_while() {
    for (int look = 0; look < 5; ++look) {
      sleep_until_ns(monotonic_ns() + 20 * kMs);
      watch_.look();
    }
    return watch_.step();
  }
  /// The first silence of at least this.
  std::optional<Stall> stall(double least_s) {
    std::optional<Stall> found;
    support::eventually([&] {
      found = after_a_while();
      return found && found->late_s >= least_s;
    });
    return found;
  }

 private:
  void work() {
    while (!ends_) {
      watch_.beat();
      sleep_until_ns(monotonic_ns() + kMs);
      if (const auto what = next_.exchange(nullptr)) what();
    }
  }

  StallWatch watch_{true};
  std::atomic<bool> ends_{false};
  std::atomic<void (*)()> next_{nullptr};
  std::thread thread_;
};

void work_for_60_ms() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  const std::int64_t until_ns = now.tv_sec * kNsPerSecond + now.tv_nsec + 60 * kMs;
  do {
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  } while (now.tv_sec * kNsPerSecond + now.tv_nsec < until_ns);
}

// Next to others' work the thread may wait for a processor for longer than it works.
TEST(StallWatchTest, NamesWorkThatLastsTooLong) {
  Watched sut;
  sut.once(&work_for_60_ms);
  const auto stall = sut.stall(0.06);
  ASSERT_TRUE(stall);
  if (stall->late_s < 0.09) {
    EXPECT_TRUE(stall->why.starts_with("worked for ")) << stall->why;
  } else {
    EXPECT_NE(stall->why, "stopped by a signal");
  }
}

TEST(StallWatchTest, ASleepHasNoReasonOfItsOwn) {
  Watched sut;
  sut.once([] { sleep_until_ns(monotonic_ns() + 400 * kMs); });
  const auto stall = sut.stall(0.4);
  ASSERT_TRUE(stall);
  EXPECT_EQ(stall->why, "");
}

// A pipe that nobody reads for 200 ms.
void write_to_a_full_pipe() {
  std::array<int, 2> ends{};
  ASSERT_EQ(pipe(ends.data()), 0);
  const std::vector<char> more_than_it_holds(2 * fcntl(ends[1], F_GETPIPE_SZ));
  std::thread reader([&] {
    sleep_until_ns(monotonic_ns() + 200 * kMs);
    std::vector<char> taken(more_than_it_holds.size());
    for (std::size_t got = 0; got < taken.size();)
      got += static_cast<std::size_t>(read(ends[0], taken.data(), taken.size()));
  });
  EXPECT_EQ(write(ends[1], more_than_it_holds.data(), more_than_it_holds.size()),
            std::ssize(more_than_it_holds));
  reader.join();
  for (const int end : ends) close(end);
}

TEST(StallWatchTest, NamesTheCallThatBlocked) {
  Watched sut;
  sut.once(&write_to_a_full_pipe);
  const auto stall = sut.stall(0.15);
  ASSERT_TRUE(stall);
  if (!stall->why.starts_with("waited ")) {  // next to others' work, for a processor
    EXPECT_EQ(stall->why, "blocked in write()");
  }
}

/// Ends with 0 when a stop of the whole process is named.
[[noreturn]] void stopped_and_continued() {
  Watched sut;
  const pid_t self = getpid();
  if (fork() == 0) {
    kill(self, SIGSTOP);
    sleep_until_ns(monotonic_ns() + 150 * kMs);
    kill(self, SIGCONT);
    _exit(0);
  }
  const auto stall = sut.stall(0.14);
  _exit(stall && stall->why == "stopped by a signal" ? 0 : 1);
}

TEST(StallWatchDeathTest, NamesASignalThatStoppedTheProcess) {
  EXPECT_EXIT(stopped_and_continued(), testing::ExitedWithCode(0), "");
}

void stay_on_the_first_processor() {
  cpu_set_t first;
  CPU_ZERO(&first);
  CPU_SET(0, &first);
  pthread_setaffinity_np(pthread_self(), sizeof(first), &first);
}

/// Keeps the first processor busy for this long, before any ordinary thread; needs the right to.
void hold_the_processor(std::int64_t length_ns) {
  stay_on_the_first_processor();
  const sched_param highest{.sched_priority = 50};
  if (sched_setscheduler(0, SCHED_FIFO, &highest) != 0) return;
  for (const std::int64_t end_ns = monotonic_ns() + length_ns; monotonic_ns() < end_ns;) {
  }
}

void stand_behind_another() {
  std::atomic<bool> ended{false};
  std::thread other([&ended] {
    hold_the_processor(120 * kMs);
    ended = true;
  });
  while (!ended) {  // runnable all the time
  }
  other.join();
}

std::string why_behind_another() {
  Watched sut;
  sut.once(&stay_on_the_first_processor);
  (void)sut.after_a_while();
  sut.once(&stand_behind_another);
  const auto stall = sut.stall(0.12);
  return stall ? stall->why : "no stall";
}

// On a busy machine a silence of before may have had the one look at the trace in two seconds, or
// others the processor for longer: then once more.
TEST(StallWatchTest, NamesTheProgramThatHadTheProcessor) {
  const SwitchTrace rights;
  const sched_param highest{.sched_priority = 50};
  if (!rights.available() || sched_setscheduler(0, SCHED_FIFO, &highest) != 0) {
    GTEST_SKIP() << "needs the kernel's trace and real-time priority";
  }
  const sched_param ordinary{.sched_priority = 0};
  sched_setscheduler(0, SCHED_OTHER, &ordinary);
  std::string why;
  EXPECT_TRUE(support::eventually([&] {
    why = why_behind_another();
    std::cout << why << '\n';
    return why.find("; unit_runtime had it for ") != std::string::npos;
  })) << why;
  EXPECT_TRUE(why.starts_with("waited ")) << why;
}

}  // namespace
}  // namespace stillhand::runtime::stall_watch_test

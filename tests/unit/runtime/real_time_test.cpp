// SPDX-License-Identifier: Apache-2.0
// In threads of their own, which alone change.  Where the system grants no real-time priority, the
// calls report that and leave the thread as it was.
#include "services/system/process/real_time.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <thread>

namespace stillhand::runtime::real_time_test {
namespace {

struct Scheduling {
  int policy, priority;
  bool operator==(const Scheduling&) const = default;
};

Scheduling now() {
  sched_param parameter{};
  sched_getparam(0, &parameter);
  return {sched_getscheduler(0), parameter.sched_priority};
}

template <typename Body>
void in_a_thread(Body body) {
  std::thread(body).join();
}

TEST(BecomeRealTimeTest, ThePolicyIsFifoOrWithKeysRoundRobin) {
  for (const bool secured : {false, true}) {
    in_a_thread([&] {
      const Scheduling before = now();
      if (become_real_time(secured)) {
        EXPECT_EQ(now(), (Scheduling{secured ? SCHED_RR : SCHED_FIFO, kControlPriority}));
      } else {
        EXPECT_EQ(now(), before);
      }
    });
  }
}

// Whatever listens to the loop goes below it and above what reports.
TEST(BecomeRealTimeTest, AListenerGoesBelowTheLoopAndAboveTheBackground) {
  in_a_thread([] {
    EXPECT_EQ(priority_of("cancellation"), kControlPriority);
    if (!become_real_time(false, priority_of("recorder"))) return;  // not granted here
    const int listener = now().priority;
    EXPECT_LT(listener, kControlPriority);
    become_background();
    EXPECT_LT(now().priority, listener);
  });
}

// Under keys a thread that shares Fast DDS's locks stays where it is.
TEST(BecomeBackgroundTest, AThreadGoesBelowTheControlPathAndStaysRealTime) {
  for (const bool secured : {false, true}) {
    for (const Locks locks : {Locks::kOwn, Locks::kFastDds}) {
      in_a_thread([&] {
        const bool granted = become_real_time(secured);
        const Scheduling before = now();
        become_background(locks);
        const bool lowered = granted && (!secured || locks == Locks::kOwn);
        EXPECT_EQ(now().policy, before.policy);
        EXPECT_EQ(now().priority < before.priority, lowered);
        EXPECT_EQ(now().priority > 0, granted);
      });
    }
  }
}

TEST(OrdinaryWhileTest, AThreadGetsItsSchedulingBack) {
  for (const bool real_time : {false, true}) {
    in_a_thread([&] {
      if (real_time) become_real_time();
      const Scheduling before = now();
      {
        const OrdinaryWhile outer;
        EXPECT_EQ(now(), (Scheduling{SCHED_OTHER, 0}));
        const OrdinaryWhile inner;
        EXPECT_EQ(now(), (Scheduling{SCHED_OTHER, 0}));
      }
      EXPECT_EQ(now(), before);
    });
  }
}

}  // namespace
}  // namespace stillhand::runtime::real_time_test

// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/switch_trace.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "services/system/process/stall_watch.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::runtime::switch_trace_test {
namespace {

constexpr std::int64_t kMs_ns = 1'000'000;
constexpr pid_t kThread = 40;

std::string line(double at_s, const std::string& left, pid_t left_id, const std::string& state,
                 const std::string& came, pid_t came_id) {
  return "  " + left + "-" + std::to_string(left_id) + "  [001] d..2.  " + std::to_string(at_s) +
         ": sched_switch: prev_comm=" + left + " prev_pid=" + std::to_string(left_id) +
         " prev_prio=120 prev_state=" + state + " ==> next_comm=" + came +
         " next_pid=" + std::to_string(came_id) + " next_prio=120\n";
}

/// The thread leaves at 1.000 s and is back at 1.070 s.
std::string trace_of(const std::string& state) {
  return "# tracer: nop\n" + line(0.9, "swapper/1", 0, "R", "sensing", kThread) +
         line(1.0, "sensing", kThread, state, "cc1plus x", 7) +
         line(1.05, "cc1plus x", 7, "R+", "swapper/1", 0) +
         line(1.06, "swapper/1", 0, "R", "as", 8) + line(1.07, "as", 8, "S", "sensing", kThread) +
         line(1.08, "sensing", kThread, "S", "cc1plus x", 7);
}

TEST(OccupationTest, SaysWhoHadTheProcessorWhileTheThreadWasAway) {
  const Occupation sut = occupation(trace_of("R"), kThread, 999 * kMs_ns, 1070 * kMs_ns);
  EXPECT_EQ(sut.left_as, 'R');
  EXPECT_EQ(sut.program, "cc1plus x");
  EXPECT_EQ(sut.had_ns, 50 * kMs_ns);
  EXPECT_EQ(sut.idle_ns, 10 * kMs_ns);
}

// It left in a silence of before, or it came back on another processor.
TEST(OccupationTest, KnowsNothingOfAnAbsenceThatIsNotTheSilence) {
  EXPECT_EQ(occupation(trace_of("D"), kThread, 1045 * kMs_ns, 1070 * kMs_ns).left_as, 0);
  EXPECT_EQ(occupation(trace_of("D"), kThread, 1045 * kMs_ns, 1070 * kMs_ns).program, "");
  EXPECT_EQ(occupation(trace_of("D"), kThread, 999 * kMs_ns, 1060 * kMs_ns).program, "");
}

TEST(OccupationTest, TakesTheStateOfTheLongestAbsence) {
  const std::string text = trace_of("R") + line(1.081, "cc1plus x", 7, "R", "sensing", kThread);
  EXPECT_EQ(occupation(text, kThread, 999 * kMs_ns, 1090 * kMs_ns).left_as, 'R');
}

TEST(OccupationTest, AProgramsNameFoolsNoField) {
  for (const char* name :
       {"x prev_pid=40 a", "a next_pid=0 b", " ==> next_comm=", "tab\tand\xff"}) {
    const std::string text =
        line(1.0, "sensing", kThread, "R", name, 7) + line(1.07, name, 7, "R+", "sensing", kThread);
    const Occupation sut = occupation(text, kThread, 999 * kMs_ns, 1070 * kMs_ns);
    EXPECT_EQ(sut.left_as, 'R') << name;
    EXPECT_EQ(sut.idle_ns, 0) << name;
    EXPECT_EQ(sut.had_ns, 70 * kMs_ns) << name;
    EXPECT_TRUE(std::ranges::all_of(sut.program, [](char c) { return c >= ' ' && c <= '~'; }));
  }
}

TEST(OccupationTest, KnowsNothingFromATraceThatDoesNotReach) {
  EXPECT_EQ(occupation("", kThread, 0, kMs_ns).program, "");
  EXPECT_EQ(occupation("12.5: sched_switch:\n: sched_switch: x", kThread, 0, kMs_ns).left_as, 0);
  const Occupation later = occupation(trace_of("R"), kThread, 0, 500 * kMs_ns);
  EXPECT_EQ(later.program, "");
  EXPECT_EQ(later.idle_ns, 0);
}

/// Of a silence from 1.000 to 1.070 s in which the thread waited for a processor, or did not.
std::string why_switched(const std::string& text, std::int64_t waited_ms) {
  return why_silent(1000 * kMs_ns, 1070 * kMs_ns, {}, {900 * kMs_ns, 0, 0, 0, 0},
                    {1100 * kMs_ns, 0, waited_ms * kMs_ns, 0, 0},
                    occupation(text, kThread, 1000 * kMs_ns, 1070 * kMs_ns));
}

TEST(OccupationTest, CompletesTheReason) {
  EXPECT_EQ(why_switched(trace_of("R"), 70),
            "waited 70 ms for a processor; cc1plus x had it for 50 ms");
  EXPECT_EQ(why_switched(line(1.0, "sensing", kThread, "R", "swapper/1", 0) +
                             line(1.07, "swapper/1", 0, "R", "sensing", kThread),
                         70),
            "waited 70 ms for a processor; it was idle: held back, as by its group's quota of "
            "processor time");
  EXPECT_EQ(why_switched("", 70), "waited 70 ms for a processor");
  EXPECT_EQ(why_switched(trace_of("T"), 0), "stopped by a signal");
  EXPECT_EQ(why_switched(trace_of("t"), 0), "stopped by a debugger");
  EXPECT_EQ(why_switched(trace_of("D"), 0),
            "blocked in the kernel, as by a disk or its group's freezer");
  EXPECT_EQ(why_switched(trace_of("R"), 5), "held back, as by its group's quota of processor time");
  EXPECT_EQ(why_switched(trace_of("R"), 30), "");
  EXPECT_EQ(why_switched(trace_of("S"), 0), "");
}

TEST(SwitchTraceTest, WithoutRightsIsNotAvailableAndLeavesNothing) {
  const support::Folder folder;
  const SwitchTrace sut(folder / "absent");
  EXPECT_FALSE(sut.available());
  EXPECT_EQ(sut.of(0, kThread, 0, kMs_ns).program, "");
}

}  // namespace
}  // namespace stillhand::runtime::switch_trace_test

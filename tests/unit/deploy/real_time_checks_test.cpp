// SPDX-License-Identifier: Apache-2.0
// Texts of kernels that are good, wrong and silent.
#include "apps/deploy/real_time_checks.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

namespace stillhand::deploy::real_time_checks_test {
namespace {

using testing::HasSubstr;

// As Debian 12's and 13's kernels and 13's real-time kernel write it.
constexpr const char* kDynamic = "Linux version 6.1.0-28-amd64 (...) #1 SMP PREEMPT_DYNAMIC Debian";
constexpr const char* kRealTime = "Linux version 6.12.48-rt-amd64 (...) #1 SMP PREEMPT_RT Debian";

TEST(RealTimeCheckTest, ThePreemptionModelIsNamed) {
  EXPECT_EQ(check_preemption(kRealTime, "").state, State::kGood);
  EXPECT_EQ(check_preemption(kDynamic, "none voluntary (full)\n").state, State::kGood);
  EXPECT_EQ(check_preemption("Linux version 5.10.0 #1 SMP PREEMPT", "").state, State::kGood);
  EXPECT_EQ(check_preemption(kDynamic, "").state, State::kNotChecked);
  const Finding wrong = check_preemption(kDynamic, "none (voluntary) full\n");
  EXPECT_EQ(wrong.state, State::kWrong);
  EXPECT_THAT(wrong.mend, HasSubstr("preempt=full"));
  EXPECT_EQ(check_preemption("Linux version 5.10.0 #1 SMP", "").state, State::kWrong);
}

TEST(RealTimeCheckTest, TheLoopNeedsHalfOfAProcessorWithoutAPause) {
  EXPECT_EQ(check_throttling("-1\n", "1000000\n").state, State::kGood);
  EXPECT_THAT(check_throttling("950000\n", "1000000\n").what, HasSubstr("95 %"));
  EXPECT_EQ(check_throttling("950000\n", "1000000\n").state, State::kGood);
  EXPECT_EQ(check_throttling("100000\n", "1000000\n").state, State::kWrong);
  EXPECT_EQ(check_throttling("0\n", "1000000\n").state, State::kWrong);
  EXPECT_EQ(check_throttling("", "1000000\n").state, State::kNotChecked);
  EXPECT_EQ(check_throttling("950000\n", "0\n").state, State::kNotChecked);
}

TEST(RealTimeCheckTest, TheDeepestSleepThatIsAllowedCounts) {
  const IdleState shallow{"C1\n", "2\n", "0\n"}, deep{"C10\n", "890\n", "0\n"},
      off{"C10\n", "890\n", "1\n"};
  EXPECT_EQ(check_idle_states({shallow, off}).state, State::kGood);
  const Finding wrong = check_idle_states({deep, shallow});
  EXPECT_EQ(wrong.state, State::kWrong);
  EXPECT_THAT(wrong.what, HasSubstr("C10, 890 us"));
  EXPECT_EQ(check_idle_states({}).state, State::kNotChecked);
}

TEST(RealTimeCheckTest, InterruptsAreNamedWithTheirProcessors) {
  const Finding found = check_interrupts({{"eth0", {"1", "0", "1"}}, {"ttyACM0", {"0-3"}}});
  EXPECT_EQ(found.what, "eth0 on processor 0, 1; ttyACM0 on processor 0-3");
  EXPECT_EQ(check_interrupts({}).state, State::kNotChecked);
}

TEST(RealTimeCheckTest, OneWakeUpThatLosesATickIsWrong) {
  std::vector<double> late_us(101);
  std::iota(late_us.rbegin(), late_us.rend(), 0.0);
  const Finding good = check_wake_ups(late_us);
  EXPECT_EQ(good.state, State::kGood);
  EXPECT_EQ(good.what, "late by 50 us in the median of 101, 1 of 100 by 99, the worst by 100");
  late_us[7] = 1001.0;
  EXPECT_EQ(check_wake_ups(late_us).state, State::kWrong);
  EXPECT_EQ(check_wake_ups(std::nullopt).state, State::kNotChecked);
}

TEST(RealTimeCheckTest, EachIsReadOfThisMachineOnce) {
  std::vector<std::string> names;
  for (const Finding& each : check_real_time_kernel()) {
    names.push_back(each.check);
    // What a machine does not show may have nothing to mend.
    if (each.state == State::kNotChecked) continue;
    EXPECT_EQ(each.mend.empty(), each.state == State::kGood) << each.check << ": " << each.what;
  }
  EXPECT_THAT(names, testing::ElementsAre("preemption", "throttling", "idle-states", "interrupts",
                                          "wake-up"));
}

}  // namespace
}  // namespace stillhand::deploy::real_time_checks_test

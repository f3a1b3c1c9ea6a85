// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "apps/lab/core/trial_run.hpp"
#include "tests/unit/lab/stage_fixture.hpp"

namespace stillhand::lab {

// Number 2, 5 s of tracking, ramps of 2 s.  The rig is at tick 100 when it begins: the ramp begins
// 1000 ticks later, the measured part at 3100, the last ramp ends at 10100.
class TrialRunTest : public StageTest {
 protected:
  static constexpr Tick kStart = 3100, kEnd = 10100;

  TrialRunTest() { sut_ = std::make_unique<TrialRun>(planned_, roster_, trouble_); }

  void arm(std::int64_t trial) {
    for (const char* name : {"rig", "cancellation", "human_operator"}) {
      seen_.processes[name].armed_trial = trial;
    }
  }
  Actions step(std::int64_t after_ns = 50 * kMs) { return StageTest::step(*sut_, after_ns); }
  /// To the middle of the trial.
  void follow() {
    step();
    arm(2);
    rig_at(5000);
    step();
    ASSERT_FALSE(sut_->over());
  }
  /// The 300 ms after the force's end.
  void pass_afterwards() {
    step();
    step(301 * kMs);
  }
  [[nodiscard]] const TrialResult& result() const { return sut_->result(); }
  /// "completed", or why the trial ended before its last tick.
  [[nodiscard]] std::string ending() const {
    if (!sut_->over()) return "it goes on";
    return result().completed ? "completed" : result().aborted;
  }

  Trial planned_{2, TrialPhase::kTracking, 0, 5000, 2000};
  std::unique_ptr<TrialRun> sut_;
};

}  // namespace stillhand::lab

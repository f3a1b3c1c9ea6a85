// SPDX-License-Identifier: Apache-2.0
#include "services/core/population/task.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "services/core/contract/config_error.hpp"
#include "services/core/rig/parts/body_response.hpp"
#include "services/core/rig/rig.hpp"

namespace stillhand::population::task_test {
namespace {

// Eq. SU-3.  Compliance at 0.05 Hz, without the reflex, which only makes holding stiffer.
TEST(TaskTest, HoldingIsStifferThanRelaxingAndGivingWayIsSofter) {
  const auto compliance = [](Task task) {
    return std::abs(rig::hand_admittance(doing({}, task), {}, false, 0.05));
  };
  EXPECT_LT(compliance(Task::kHold), compliance(Task::kRelax));
  EXPECT_LT(compliance(Task::kRelax), compliance(Task::kGiveWay));
  const rig::BodyConfig hold = doing({}, Task::kHold);
  EXPECT_EQ(hold.neuromuscular.reflex_stiffness_n_m, 250.0);
  EXPECT_EQ(hold.neuromuscular.reflex_damping_n_s_m, 250.0 * 0.125);
  EXPECT_EQ(hold.neuromuscular.reflex_delay_s, 0.035);
  const rig::BodyConfig yielding = doing(hold, Task::kGiveWay);
  EXPECT_EQ(yielding.neuromuscular.reflex_stiffness_n_m, 0.0);
  EXPECT_EQ(yielding.cocontraction_damping_factor, 1.0);
  EXPECT_EQ(yielding.shoulder_stiffness_n_m, 0.5 * hold.shoulder_stiffness_n_m);
  EXPECT_EQ(yielding.shoulder_damping_n_s_m, std::sqrt(0.5) * hold.shoulder_damping_n_s_m);
}

TEST(TaskTest, ABodyOfEveryTaskIsOneThatTheRigTakes) {
  for (const char* word : {"hold", "relax", "give-way"}) {
    rig::RigConfig config;
    config.body = doing(config.body, task_from(word));
    EXPECT_NO_THROW(rig::Rig{config}) << word;
  }
  EXPECT_THROW(task_from("push"), ConfigError);
}

}  // namespace
}  // namespace stillhand::population::task_test

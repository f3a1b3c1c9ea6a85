// SPDX-License-Identifier: Apache-2.0
#include "services/core/population/task.hpp"

#include <cmath>

#include "services/core/contract/config_error.hpp"

namespace stillhand::population {
namespace {

// Eq. SU-3.
constexpr double kReflex_n_m = 250.0;
constexpr double kReflexDampingTime_s = 0.125;
constexpr double kReflexDelay_s = 0.035;
constexpr double kYielding = 0.5;

}  // namespace

Task task_from(const std::string& word) {
  if (word == "hold") return Task::kHold;
  if (word == "relax") return Task::kRelax;
  if (word == "give-way") return Task::kGiveWay;
  throw ConfigError("task", word, "hold, relax or give-way");
}

rig::BodyConfig doing(rig::BodyConfig body, Task task) {
  rig::NeuromuscularConfig& nerves = body.neuromuscular;
  if (task == Task::kHold) {
    nerves.reflex_stiffness_n_m = kReflex_n_m;
    nerves.reflex_damping_n_s_m = kReflexDampingTime_s * kReflex_n_m;
    nerves.reflex_delay_s = kReflexDelay_s;
    return body;
  }
  body.cocontraction_stiffness_factor = body.cocontraction_damping_factor = 1.0;
  nerves.reflex_stiffness_n_m = nerves.reflex_damping_n_s_m = 0.0;
  if (task == Task::kGiveWay) {
    body.shoulder_stiffness_n_m *= kYielding;
    body.shoulder_damping_n_s_m *= std::sqrt(kYielding);
  }
  return body;
}

}  // namespace stillhand::population

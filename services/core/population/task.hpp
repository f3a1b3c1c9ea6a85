// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/rig/parts/body_config.hpp"

namespace stillhand::population {

/// What a person does with a stick that is perturbed, as in Venrooij et al. (2011): three tasks,
/// each with another setting of nerves and muscles.
enum class Task {
  kHold,     ///< hold the position
  kRelax,    ///< relax
  kGiveWay,  ///< give way to the force
};

/// "hold", "relax" or "give-way".
/// @throws stillhand::ConfigError for any other word.
Task task_from(const std::string& word);

/// The body while it does this with the free stick, README Eq. SU-3.  Pure.
rig::BodyConfig doing(rig::BodyConfig body, Task task);

}  // namespace stillhand::population

// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/part_step.hpp"

#include <sstream>

#include "services/core/cancellation/model_check.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::cancellation {

std::string key_of(const Part& part) {
  return "mitigation.part " + std::to_string(static_cast<int>(part.kind));
}

HandCompliance sound_hand(const Part& part, const HandCompliance& hand) {
  if (is_hand(hand)) return hand;
  std::ostringstream got;
  got << "a hand of " << hand.mass_kg << " kg, " << hand.damping_n_s_m << " N s/m, "
      << hand.stiffness_n_m << " N/m, lever " << hand.lever_m << " m";
  throw ConfigError(key_of(part), got.str(),
                    "0.1 to 10 kg, 0.01 to 1 of critical damping, 50 to 10000 N/m, lever 0.02 to "
                    "0.5 m");
}

}  // namespace stillhand::cancellation

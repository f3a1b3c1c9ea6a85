// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::human_operator {

/// Input of the subject in one tick.
struct OperatorInput {
  Tick tick;
  double target_m;         ///< x_r on the screen, positive right of its centre
  double cursor_m;         ///< x_p, same frame
  bool active;             ///< a tracking trial runs and its samples arrive
  double felt_m_s2 = 0.0;  ///< a_y of the platform; 0 where the subject feels none
};

/// Output of the subject, simulated or real.
struct OperatorOutput {
  double force_n;  ///< f_t, volitional force at the hand, + right
  Flags flags;  ///< kInputGap, kInputInvalid, kInputStale, kSaturated, kSlewLimited, kRampingDown
};

}  // namespace stillhand::human_operator

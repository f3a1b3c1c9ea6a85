// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/session.h"
#include "services/core/contract/trial.hpp"

namespace stillhand::runtime {

/// The trial that trial control announces; none (Trial{}) where its ticks are not sound().
inline Trial from_idl(const stillhand_msgs::TrialControl& message) {
  Trial trial;
  trial.number = message.trial();
  trial.phase = message.phase() == stillhand_msgs::PHASE_PEGGED     ? TrialPhase::kPegged
                : message.phase() == stillhand_msgs::PHASE_TRACKING ? TrialPhase::kTracking
                : message.phase() == stillhand_msgs::PHASE_FREE     ? TrialPhase::kFree
                                                                    : TrialPhase::kIdle;
  trial.start_tick = message.start_tick();
  trial.duration_ticks = message.duration_ticks();
  trial.ramp_ticks = message.ramp_ticks();
  return trial.sound() ? trial : Trial{};
}

}  // namespace stillhand::runtime

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/session.h"

namespace stillhand {

/// True while samples flow and misses count, including a pause between two trials.
inline bool is_running(stillhand_msgs::SessionState session) noexcept {
  return session == stillhand_msgs::SESSION_RUNNING || session == stillhand_msgs::SESSION_PAUSED;
}

}  // namespace stillhand

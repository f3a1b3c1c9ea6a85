// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand {

/// What the platform may do at a tick: the answer of runtime::PlatformPermission.
enum class MotionLeave : std::uint8_t {
  kHold,    ///< brake to rest and hold
  kEngage,  ///< a trial was announced: come slowly from where it stands to where the trial begins
  kFollow   ///< the trial covers the tick: follow the command
};

}  // namespace stillhand

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand {

/// Reasons why an output is restricted.  Published and recorded with the sample; combined with
/// bitwise OR.
enum Flag : std::uint32_t {
  kGood = 0u,
  kInputGap = 1u << 0,      ///< at least one tick was lost since the last input; the state was held
  kSaturated = 1u << 1,     ///< clipped at a limit, still valid
  kSlewLimited = 1u << 2,   ///< rate of change was clipped, still valid
  kInputStale = 1u << 3,    ///< an input is older than allowed; treated as absent
  kInputInvalid = 1u << 4,  ///< an input was NaN, infinite or out of its range; treated as absent
  kInhibited = 1u << 5,     ///< the interlock is open: a required process or link is missing
  kWorkspaceLimit = 1u << 6,  ///< the platform guard changed the motion
  kNoModel = 1u << 7,         ///< no usable feedthrough model is loaded
  kRampingDown = 1u << 8,     ///< the force ramps to zero
  kAtStop = 1u << 9,          ///< the stick touches a mechanical stop
  kFault = 1u << 31,          ///< output is zero until reset
};

using Flags = std::uint32_t;

}  // namespace stillhand

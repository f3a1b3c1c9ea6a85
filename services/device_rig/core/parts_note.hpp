// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace stillhand::device_rig {

/// First words of the rig's note of which parts it is made (README, "Settings"): in each recording,
/// at the first tick and at each trial.  What reads a session names its parts by this note.
inline constexpr std::string_view kPartsNote = "rig of devices: ";

}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace stillhand::device_rig {

/// First words of the rig's note of which parts it is made (README.md): in each recording,
/// at the first tick and at each trial.  What reads a session names its parts by this note.
inline constexpr std::string_view kPartsNote = "rig of devices: ";

/// An event's source and text are that note.
constexpr bool is_parts_note(std::string_view source, std::string_view text) {
  return source == "rig" && text.starts_with(kPartsNote);
}

}  // namespace stillhand::device_rig

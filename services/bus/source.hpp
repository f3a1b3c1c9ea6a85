// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace stillhand::runtime {

/// The first 12 bytes of the GUID of everything that a participant owns (RTPS GuidPrefix).
using ParticipantId = std::array<std::uint8_t, 12>;

/// The participant that writes for one process of a session.
struct Source {
  std::string service;  ///< one of topics::kServices
  ParticipantId participant{};
  bool operator==(const Source&) const = default;
};

/// 24 hexadecimal digits.
std::string text_of(const ParticipantId& participant);
/// @throws ConfigError for anything but 24 hexadecimal digits; `name` is what the error names.
ParticipantId participant_of(const std::string& text, const std::string& name);

}  // namespace stillhand::runtime

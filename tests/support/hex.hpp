// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <vector>

namespace stillhand {

/// Two digits for each byte, as makers print their exchanges.
inline std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t each : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x", each);
    text += digits;
  }
  return text;
}

/// The reverse.
inline std::vector<std::uint8_t> bytes(const std::string& digits) {
  std::vector<std::uint8_t> out;
  for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
    out.push_back(static_cast<std::uint8_t>(std::stoul(digits.substr(i, 2), nullptr, 16)));
  }
  return out;
}

}  // namespace stillhand

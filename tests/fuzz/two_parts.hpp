// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>

namespace stillhand::fuzz {

/// An input with a text and bytes in it: the text ends at the first zero, the bytes begin there.
struct TwoParts {
  std::string_view text;
  std::span<const std::uint8_t> bytes;  ///< with the zero; empty: there is none
};

inline TwoParts two_parts(const std::uint8_t* bytes, std::size_t size) {
  const auto* end = std::find(bytes, bytes + size, std::uint8_t{0});
  return {{reinterpret_cast<const char*>(bytes), static_cast<std::size_t>(end - bytes)},
          {end, bytes + size}};
}

}  // namespace stillhand::fuzz

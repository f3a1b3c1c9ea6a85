// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand {

/// The core's enumerator of one from the bus, where both have one order.  Fast DDS 3 gives
/// enumerators a sign, so that a hostile one may be below zero.
/// @param last       the last one that both know
/// @param otherwise  for a number of another version, or below zero
template <typename Core, typename Bus>
constexpr Core of_bus(Bus number, Bus last, Core otherwise) noexcept {
  const auto place = static_cast<std::uint32_t>(number);
  return place <= static_cast<std::uint32_t>(last) ? static_cast<Core>(place) : otherwise;
}

}  // namespace stillhand

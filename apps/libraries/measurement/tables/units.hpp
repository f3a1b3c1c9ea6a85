// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace stillhand::measurement {

/// A measured value in another unit, Eq. ME-5:
///
///   y = ((x * factor / divisor) * scale / parts) + offset
///
/// `parts` is a whole number: 0.001 is stored as one of 1000 parts, so that 13 ms become the double
/// that "0.013" is read as.  Source: UDUNITS-2's table of units.  Pure.
struct UnitConversion {
  double factor = 1.0;   ///< of a mapping, "* 22.5 [N/V]"
  double divisor = 1.0;  ///< of a mapping, "/ 102.4 [mV/g]"
  double scale = 1.0;
  double parts = 1.0;
  double offset = 0.0;  ///< of a scale that does not begin at 0, such as degrees Celsius

  [[nodiscard]] bool is_identity() const noexcept;
  void apply(std::vector<double>& values) const noexcept;
};

/// A gain between the unit of a column and that of the channel.
struct Gain {
  double number = 1.0;
  bool divides = false;
  std::string unit;  ///< empty: none, the number changes the value and not the unit
};

/// @param from  unit of the values; "-" and "" are the number 1
/// @param to    unit that is wanted
/// @returns nothing if one unit is not known or the two measure different things; two equal texts
///          always convert.  `g` is standard gravity where a gram makes no sense.
/// @throws stillhand::ConfigError if UDUNITS-2's table is missing on this machine.
std::optional<UnitConversion> unit_conversion(const std::string& from, const Gain& gain,
                                              const std::string& to);

/// True for a unit that UDUNITS-2 knows.
bool is_unit(const std::string& text);

}  // namespace stillhand::measurement

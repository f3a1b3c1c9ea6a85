// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillhand::measurement {

/// Name and unit of a column's title.
struct Title {
  std::string name;
  std::string unit;  ///< empty: none stated
};

/// Reads "name [unit]", "name (unit)" and "name / unit", the last where UDUNITS-2 knows the unit;
/// any other text is a name.  Quotes around it are no part of it.  Pure.
Title parse_title(std::string_view title);

/// Text without blanks at its ends, and without one pair of double quotes around it.
std::string_view plain_cell(std::string_view text);

/// "a, b, c", of a longer list the first six.
std::string listed(const std::vector<std::string>& names);

}  // namespace stillhand::measurement

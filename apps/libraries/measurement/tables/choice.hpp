// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/measurement/tables/mapping.hpp"
#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// Where the columns of a mapping lie in a file.
struct Choice {
  std::vector<std::size_t> columns;  ///< numbers in TableHead::columns, in the order of the mapping
  std::optional<std::size_t> time;   ///< place of the time in `columns`
};

/// @throws stillhand::ConfigError naming a column that the file lacks, or a channel that comes
/// twice
Choice choose(const TableHead& head, const Mapping& mapping);

/// A column by its title, its name, its place "#3", or either of the first two in another case.
/// @throws stillhand::ConfigError listing the titles
std::size_t find_column(const TableHead& head, const std::string& from);

/// Units of the values in the file and of the channel.
std::pair<std::string, std::string> units_of(const ColumnHead& column, const ColumnWish& wish);

/// @throws stillhand::ConfigError if the units do not convert
UnitConversion conversion_of(const TableHead& head, const ColumnHead& column,
                             const ColumnWish& wish);

/// "'time', 'acc', 'force'", the first dozen.
std::string titles_of(const TableHead& head);

/// ASCII letters in lower case.
std::string lower_case(std::string text);

}  // namespace stillhand::measurement

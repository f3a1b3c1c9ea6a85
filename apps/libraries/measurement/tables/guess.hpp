// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "apps/libraries/measurement/tables/mapping.hpp"

namespace stillhand::measurement {

/// The mapping that the titles of a file suggest: time, accelerations, force, angles, cursor.  It
/// is a guess for a person to correct, and never used without being confirmed: direction and sign
/// of an axis are in no title.  Each of Stillhand's names is given to one column at most.
Mapping guess_mapping(const TableHead& head);

/// Guess for one column; empty: nothing resembles it.
std::optional<ColumnWish> guess_column(const ColumnHead& column, std::size_t number,
                                       const TableHead& head);

/// True for columns of a recorder's own, which are no channel: counters, halves of a stamp,
/// covariances.
bool is_bookkeeping(const ColumnHead& column);

/// How a column is named in a mapping: its title where it is the only one, else "#3".
std::string reference_to(const TableHead& head, std::size_t number);

/// "--map 'time=t [s]' 'acc=a_y [m/s^2]'", ready for a shell.
std::string command_words(const Mapping& mapping);

}  // namespace stillhand::measurement

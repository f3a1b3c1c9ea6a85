// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/libraries/measurement/tables/table_file.hpp"
#include "apps/libraries/measurement/tables/text_encoding.hpp"

namespace stillhand::measurement {

/// A text table: comma, semicolon, tab or blanks between columns, decimal point or comma, in UTF-8,
/// UTF-16 or Windows-1252; RECORDINGS_OF_OTHER_PROGRAMS.md "Text tables".
std::unique_ptr<TableFile> text_table(DecodedText text, const std::string& path,
                                      const TextForm& form, std::size_t most_values);

}  // namespace stillhand::measurement

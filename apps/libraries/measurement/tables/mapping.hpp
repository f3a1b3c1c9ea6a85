// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/measurement/tables/table_file.hpp"
#include "apps/libraries/measurement/tables/units.hpp"

namespace stillhand::measurement {

/// One column of a file as a channel: "TITLE=NAME [UNIT] * NUMBER [UNIT]".
struct ColumnWish {
  std::string from;  ///< title or name of the column, or "#3", its place from 1
  std::string name;  ///< of the channel; "t": the time
  std::string unit;  ///< empty: none stated
  Gain gain;
};

/// What a person states about a file of another program.
struct Mapping {
  std::vector<ColumnWish> columns;  ///< empty: the titles themselves say it
  std::optional<double> rate_hz;    ///< [Hz] for files without times
  TextForm form;

  [[nodiscard]] bool empty() const noexcept {
    return columns.empty() && !rate_hz && form.separator == 0 && form.decimal == 0;
  }
};

/// Reads one --map.  The last '=' divides that leaves a channel on its right side, so a title may
/// hold '=' too.
/// @throws stillhand::ConfigError naming `place` ("--map") and the form
ColumnWish parse_wish(const std::string& text, const std::string& place = "--map");

/// "TITLE=NAME [UNIT]", as parse_wish() reads it.
std::string wish_text(const ColumnWish& wish);

/// ',' ';' tab, blank, by sign or word.  @throws stillhand::ConfigError
char parse_separator(const std::string& text, const std::string& place);
/// '.' or ','.  @throws stillhand::ConfigError
char parse_decimal(const std::string& text, const std::string& place);
/// @throws stillhand::ConfigError unless positive and finite
double check_rate_hz(double rate_hz, const std::string& place);

/// A mapping as YAML: the keys map (a list of texts as above), rate_hz, separator, decimal.
/// @throws stillhand::ConfigError with its place
Mapping parse_mapping(const std::string& yaml, const std::string& origin);
/// parse_mapping() of a file.
Mapping read_mapping(const std::string& path);
/// The reverse, with a first line that names the recording.
std::string mapping_yaml(const Mapping& mapping, const std::string& recording);

/// SI unit of a channel whose name has one (t, a_x, ..., f, f_motor), or empty.
std::string si_unit(const std::string& name);

}  // namespace stillhand::measurement

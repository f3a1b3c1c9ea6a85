// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::report {

/// A file that a result was made from.
struct SourceFile {
  std::string name;    ///< as the user gave it
  std::string sha256;  ///< hexadecimal; empty: not a plain file, such as a pipe
};

/// Where a result came from: entry `provenance` of a JSON file.
struct Provenance {
  std::string version;  ///< of the program
  std::string date;     ///< UTC, ISO 8601: "2026-11-26T13:50:00Z"
  std::string command;  ///< that can be pasted into a shell
  std::vector<SourceFile> sources;
};

/// Of this call.  The time is the machine's; if the variable SOURCE_DATE_EPOCH is set (seconds
/// since 1970, reproducible-builds.org), it is that one, and the same call gives the same bytes.
/// @throws std::runtime_error for a file that cannot be read
Provenance provenance_of_this_call(const std::vector<std::filesystem::path>& sources);

/// "stillhand 0.1.0, 2026-11-26T13:50:00Z": program and time of this call.
std::string made_by();

/// "2026-11-26T13:50:00Z"
std::string utc(std::int64_t seconds_since_1970);

nlohmann::ordered_json json_of(const Provenance& provenance);
/// A JSON object's text with the entry `provenance` at its end, laid out with two blanks.
std::string with_provenance(std::string_view json, const Provenance& provenance);
/// The entry, if the text is a JSON object with a well-formed one.
std::optional<Provenance> provenance_in(std::string_view json);

/// One line for people.
std::string in_words(const Provenance& provenance);

}  // namespace stillhand::report

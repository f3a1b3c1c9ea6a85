// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/contract/config_field.hpp"

namespace stillhand::settings {

/// One value of a settings file, with its place.
struct Entry {
  enum class Kind : std::uint8_t { kNull, kScalar, kMap, kSequence };

  Kind kind = Kind::kNull;
  std::string key;
  std::string text;             ///< scalar only
  bool quoted = false;          ///< scalar in quotes: a string, never a number
  std::string place;            ///< "file:line:column" of the value, counted from 1
  std::string key_place;        ///< place of its key
  std::vector<Entry> children;  ///< map: in the order of the file
};

/// Parses one YAML document.  An empty document is an empty map.
/// @throws stillhand::ConfigError for malformed YAML, a duplicate key, or a top level that is not a
/// map.
Entry parse_text(const std::string& yaml, const std::string& source_name);
/// @throws stillhand::ConfigError also if the file is missing or unreadable.
Entry parse_file(const std::filesystem::path& file);

/// Description of an entry for messages: its text, "nothing", "a map" or "a list".
std::string got_of(const Entry& entry);

/// Visitor of a Config's `fields()` that sets the fields whose keys are in the section.
class SectionReader {
 public:
  /// @param section  outlives the reader; a map or null (nothing set)
  /// @param scope    prefix of keys in messages
  /// @throws stillhand::ConfigError if the section is not a map.
  SectionReader(const Entry& section, std::string scope);

  void operator()(std::string_view name, double& value, Range range, std::string_view doc);
  void operator()(std::string_view name, std::int64_t& value, Range range, std::string_view doc);
  void operator()(std::string_view name, bool& value, Range range, std::string_view doc);
  void operator()(std::string_view name, std::string& value, Range range, std::string_view doc);

  template <typename Group>
  void group(std::string_view name, Group& fields) {
    if (const Entry* entry = find(name)) {
      SectionReader inner(*entry, scope_ + "." + std::string(name));
      Group::fields(inner, fields);
      inner.refuse_unknown();
    }
  }

  /// The entry of that name, or nullptr; marks the name as known.  For an entry that is no field,
  /// such as a list.
  const Entry* find(std::string_view name);

  /// Call this after the last field.  @throws stillhand::ConfigError with the first key that is not
  /// a field, and the nearest name of a field.
  void refuse_unknown() const;

 private:
  [[noreturn]] void fail(const Entry& entry, const std::string& want) const;

  const Entry& section_;
  std::string scope_;
  std::vector<std::string> names_;
};

}  // namespace stillhand::settings

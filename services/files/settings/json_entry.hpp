// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::settings {

/// An entry of a JSON file, with its path for messages.  The value of the file must outlive it.
class JsonEntry {
 public:
  using Json = nlohmann::ordered_json;

  JsonEntry(const Json& json, std::string path) : json_(json), path_(std::move(path)) {}

  /// All of these throw stillhand::ConfigError with the path, the present and the wanted value.
  [[nodiscard]] JsonEntry at(const std::string& key) const;
  /// False for what is no object, too.
  [[nodiscard]] bool has(const std::string& key) const { return json_.contains(key); }
  /// Refuses an object with any other key, because such a key would have no effect.
  void allow_only(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] bool is_null() const { return json_.is_null(); }
  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] std::int64_t whole() const;  ///< a whole number of either sign
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  /// Entries of an array with `least` to `most` entries.
  [[nodiscard]] std::vector<JsonEntry> entries(std::size_t least, std::size_t most) const;
  [[nodiscard]] std::vector<double> numbers(std::size_t least, std::size_t most) const;
  [[noreturn]] void refuse(const std::string& want) const;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  const Json& json_;
  std::string path_;
};

/// @param want  the wanted text, for the message, for example "JSON of a stillhand model"
/// @throws stillhand::ConfigError with line and column, or with a number that a double cannot hold.
JsonEntry::Json parsed_json(std::string_view json, const std::string& origin,
                            const std::string& want);

}  // namespace stillhand::settings

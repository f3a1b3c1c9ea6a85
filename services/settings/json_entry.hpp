// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::settings {

/// An entry of a JSON file, with the path to it for messages.  The file's own value must outlive
/// it.
class JsonEntry {
 public:
  using Json = nlohmann::ordered_json;

  JsonEntry(const Json& json, std::string path) : json_(json), path_(std::move(path)) {}

  /// All of these throw stillhand::ConfigError naming the path, what is there and what is wanted.
  [[nodiscard]] JsonEntry at(const std::string& key) const;
  /// Refuses an object with any other key: what wouldn't be read isn't passed over in silence.
  void allow_only(std::initializer_list<std::string_view> keys) const;
  [[nodiscard]] bool is_null() const { return json_.is_null(); }
  [[nodiscard]] double number() const;  ///< finite
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] bool boolean() const;
  [[nodiscard]] std::string text() const;
  /// Entries of an array of `least` to `most`.
  [[nodiscard]] std::vector<JsonEntry> entries(std::size_t least, std::size_t most) const;
  [[nodiscard]] std::vector<double> numbers(std::size_t least, std::size_t most) const;
  [[noreturn]] void refuse(const std::string& want) const;
  [[nodiscard]] const std::string& path() const noexcept { return path_; }

 private:
  const Json& json_;
  std::string path_;
};

/// @param want  what the text should be, for the message, for example "JSON of a stillhand model"
/// @throws stillhand::ConfigError naming line and column, or a number that doesn't fit.
JsonEntry::Json parsed_json(std::string_view json, const std::string& origin,
                            const std::string& want);

}  // namespace stillhand::settings

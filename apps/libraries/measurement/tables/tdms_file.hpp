// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::measurement::tdms {

struct Property {
  double number = 0.0;
  std::string text;
};

// Rows from `first` on begin at `start_s`: a recording that was stopped and went on has several.
struct Block {
  std::size_t first = 0;
  double start_s = 0.0;
  double step_s = 0.0;

  bool operator==(const Block&) const = default;
};

/// A channel, a group or the file.
struct Object {
  std::string path;
  std::map<std::string, Property, std::less<>> properties;  // those that are of use
  std::uint32_t type = 0;                                   // of its raw data, and in each chunk:
  std::uint64_t count = 0;
  std::uint64_t text_bytes = 0;
  std::vector<Block> blocks;
  std::vector<double> values;

  [[nodiscard]] double number(std::string_view name) const {
    const auto found = properties.find(name);
    return found == properties.end() ? 0.0 : found->second.number;
  }
  [[nodiscard]] std::string text(std::string_view name) const {
    const auto found = properties.find(name);
    return found == properties.end() ? std::string() : found->second.text;
  }
  [[nodiscard]] Block block_from(std::size_t row) const {
    return {row, number("wf_start_time") + number("wf_start_offset"), number("wf_increment")};
  }
};

struct File {
  std::vector<Object> objects;
  bool cut = false;  ///< its last segment is read as far as it goes
};

/// "group.channel"
std::string title_of(const Object& object);

/// @throws stillhand::ConfigError "got WHAT, want WANT", with the line that makes a CSV of the file
[[noreturn]] void refuse(const std::string& path, const std::string& what, const std::string& want);

/// @param path  for messages
/// @throws stillhand::ConfigError for what NI's document does not state, or what contradicts it
File parse(std::span<const std::byte> bytes, const std::string& path, std::size_t most_values);

}  // namespace stillhand::measurement::tdms

// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/describe.hpp"

#include <array>
#include <charconv>
#include <cmath>

namespace stillhand::settings {
namespace {

// The shortest text that gives the same number again.
std::string shortest(double value) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return {text.data(), end};
}

std::string allowed(Range range) { return shortest(range.min) + " to " + shortest(range.max); }

// A bar would end the cell of the table.
std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '|') out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

void TableWriter::operator()(std::string_view name, double value, Range range,
                             std::string_view doc) {
  row(name, shortest(value), allowed(range), doc);
}

void TableWriter::operator()(std::string_view name, std::int64_t value, Range range,
                             std::string_view doc) {
  row(name, std::to_string(value), allowed(range), doc);
}

void TableWriter::operator()(std::string_view name, bool value, Range range, std::string_view doc) {
  const bool both = range.min <= 0.0 && range.max >= 1.0;
  row(name, value ? "true" : "false", both ? "true, false" : (value ? "true" : "false"), doc);
}

void TableWriter::operator()(std::string_view name, const std::string& value, Range range,
                             std::string_view doc) {
  row(name, "\"" + value + "\"", allowed(range) + " characters", doc);
}

void TableWriter::row(std::string_view name, const std::string& value, const std::string& range,
                      std::string_view doc) {
  rows_ += "| `" + prefix_ + std::string(name) + "` | " + escaped(value) + " | " + range + " | " +
           escaped(doc) + " |\n";
}

}  // namespace stillhand::settings

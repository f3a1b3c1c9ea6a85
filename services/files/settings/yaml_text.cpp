// SPDX-License-Identifier: Apache-2.0
#include "services/files/settings/yaml_text.hpp"

#include <fmt/format.h>

namespace stillhand::settings {
namespace {

// Single quotes: YAML then reads every character as it is, and a doubled quote as one.
std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    out += c;
    if (c == '\'') out += c;
  }
  return out + "'";
}

}  // namespace

void YamlWriter::operator()(std::string_view name, double value, Range, std::string_view) {
  line(name, fmt::format(" {}", value));  // the shortest text that gives the same number again
}

void YamlWriter::operator()(std::string_view name, std::int64_t value, Range, std::string_view) {
  line(name, fmt::format(" {}", value));
}

void YamlWriter::operator()(std::string_view name, bool value, Range, std::string_view) {
  line(name, fmt::format(" {}", value));
}

void YamlWriter::operator()(std::string_view name, const std::string& value, Range,
                            std::string_view) {
  line(name, " " + quoted(value));
}

void YamlWriter::line(std::string_view name, const std::string& value) {
  text_ += fmt::format("{}{}:{}\n", indent_, name, value);
}

}  // namespace stillhand::settings

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/core/contract/config_field.hpp"

namespace stillhand::settings {

/// Visitor that writes each field as a line of YAML; a group is a nested map.
class YamlWriter {
 public:
  explicit YamlWriter(std::string indent = {}) : indent_(std::move(indent)) {}

  void operator()(std::string_view name, double value, Range, std::string_view);
  void operator()(std::string_view name, std::int64_t value, Range, std::string_view);
  void operator()(std::string_view name, bool value, Range, std::string_view);
  void operator()(std::string_view name, const std::string& value, Range, std::string_view);

  template <typename Group>
  void group(std::string_view name, const Group& fields) {
    YamlWriter inner(indent_ + "  ");
    Group::fields(inner, fields);
    line(name, "");
    text_ += inner.text_;
  }

  [[nodiscard]] const std::string& text() const noexcept { return text_; }

 private:
  void line(std::string_view name, const std::string& value);

  std::string indent_;
  std::string text_;
};

/// Every field of a Config as YAML: load_text() gives the same Config again, bit for bit.
template <typename Config>
std::string yaml_text(const Config& config) {
  YamlWriter writer;
  Config::fields(writer, config);
  return writer.text();
}

}  // namespace stillhand::settings

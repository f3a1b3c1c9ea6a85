// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/core/contract/config_field.hpp"

namespace stillhand::settings {

/// Visitor that writes one Markdown table row for each field; the name of a group is a dotted
/// prefix.
class TableWriter {
 public:
  explicit TableWriter(std::string prefix = {}) : prefix_(std::move(prefix)) {}

  void operator()(std::string_view name, double value, Range range, std::string_view doc);
  void operator()(std::string_view name, std::int64_t value, Range range, std::string_view doc);
  void operator()(std::string_view name, bool value, Range range, std::string_view doc);
  void operator()(std::string_view name, const std::string& value, Range range,
                  std::string_view doc);

  template <typename Group>
  void group(std::string_view name, const Group& fields) {
    TableWriter inner(prefix_ + std::string(name) + ".");
    Group::fields(inner, fields);
    rows_ += inner.rows_;
  }

  [[nodiscard]] const std::string& rows() const noexcept { return rows_; }

 private:
  void row(std::string_view name, const std::string& value, const std::string& range,
           std::string_view doc);

  std::string prefix_;
  std::string rows_;
};

/// The Markdown table "name | default | range | doc" of a Config, with the values of `config`.
template <typename Config>
std::string describe(const Config& config) {
  TableWriter writer;
  Config::fields(writer, config);
  return "| name | default | range | doc |\n| --- | --- | --- | --- |\n" + writer.rows();
}

}  // namespace stillhand::settings

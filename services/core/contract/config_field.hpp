// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <string_view>
#include <type_traits>

#include "services/core/contract/config_error.hpp"

namespace stillhand {

/// Closed interval of allowed values, in the unit of the field.
struct Range {
  double min;
  double max;
};

// The Config of a core describes its fields once, in one static function template:
//
//   struct Config {
//     double trunk_mass_kg = 30.0;
//     BodyConfig body;
//     template <typename Visitor, typename Self>
//     static void fields(Visitor&& visit, Self& self) {
//       visit("trunk_mass_kg", self.trunk_mass_kg, Range{5.0, 80.0}, "[kg] moving upper body;
//       Winter (2009)"); visit.group("body", self.body);
//     }
//   };
// `self` is const or not, as the visitor needs.  Fields are double, std::int64_t, bool (Range{0,
// 1}) or std::string (Range is the length).  Three parts use this description: the YAML reader
// (services/files/settings), the check of the bounds, and the printed list of settings.

/// Visitor that throws ConfigError for the first field outside its range; NaN is outside every
/// range.
class FieldValidator {
 public:
  explicit FieldValidator(std::string scope) : scope_(std::move(scope)) {}

  template <typename T>
  void operator()(std::string_view name, const T& value, Range range, std::string_view /*doc*/) {
    std::ostringstream got;
    std::ostringstream want;
    double number = 0.0;
    if constexpr (std::is_same_v<T, std::string>) {
      number = static_cast<double>(value.size());
      got << '"' << value << '"';
      want << "text of " << range.min << " to " << range.max << " characters";
    } else {
      number = static_cast<double>(value);
      got << number;
      want << "a value from " << range.min << " to " << range.max;
    }
    if (!(number >= range.min && number <= range.max)) {
      throw ConfigError(scope_ + "." + std::string(name), got.str(), want.str());
    }
  }

  template <typename Group>
  void group(std::string_view name, const Group& fields) {
    FieldValidator inner(scope_ + "." + std::string(name));
    Group::fields(inner, fields);
  }

 private:
  std::string scope_;
};

/// Checks every field of a Config against its range.
/// @param scope  prefix of the keys in messages, for example "rig"
/// @throws ConfigError with the first field that is out of range.
template <typename Config>
void validate(const Config& config, const std::string& scope) {
  FieldValidator visitor(scope);
  Config::fields(visitor, config);
}

}  // namespace stillhand

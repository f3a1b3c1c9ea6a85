// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <type_traits>

namespace stillhand::report {

/// JSON has no NaN and no infinity: a number that could not be computed is null.
inline nlohmann::ordered_json or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// A number, an interval or a pair that there may not be.
template <typename Value>
nlohmann::ordered_json or_null(const std::optional<Value>& value) {
  if (!value) return nullptr;
  if constexpr (std::is_same_v<Value, double>) {
    return or_null(*value);
  } else if constexpr (requires {
                         value->low;
                         value->high;
                       }) {
    return {value->low, value->high};
  } else {
    return *value;
  }
}

/// A name or a reason; null where there is none.
inline nlohmann::ordered_json or_null(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

}  // namespace stillhand::report

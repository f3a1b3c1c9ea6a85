// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace stillhand::report {

/// JSON has no NaN and no infinity: a number that could not be computed is null.
inline nlohmann::ordered_json or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

/// A number that there may not be.
inline nlohmann::ordered_json or_null(const std::optional<double>& value) {
  return value ? or_null(*value) : nlohmann::ordered_json(nullptr);
}

/// A name or a reason; null where there is none.
inline nlohmann::ordered_json or_null(const std::string& text) {
  return text.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(text);
}

}  // namespace stillhand::report

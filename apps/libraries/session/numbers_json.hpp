// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>

#include "apps/libraries/session/core/trial_numbers.hpp"

namespace stillhand::session {

/// {"rms_error_mm": value(0), ...} of the paper's metrics, by a name of the table.
template <typename Value>
nlohmann::ordered_json of_each_metric(const char* Number::* name, Value value) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < kMetrics.size(); ++k) out[kMetrics[k].*name] = value(k);
  return out;
}

}  // namespace stillhand::session

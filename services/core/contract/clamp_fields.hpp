// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "services/core/contract/config_field.hpp"

namespace stillhand::settings {

/// Visitor that sets a number outside its range to the end of that range.
struct ClampFields {
  void operator()(const char*, double& value, Range range, const char*) const {
    value = std::clamp(value, range.min, range.max);
  }
};

/// For settings of numbers alone, without groups.
template <typename Config>
void clamp_fields(Config& config) {
  ClampFields visit;
  Config::fields(visit, config);
}

}  // namespace stillhand::settings

// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/sample_check.hpp"

#include <cmath>

#include "services/core/contract/config_error.hpp"

namespace stillhand::statistics {
void require_sample(const std::vector<double>& values, std::size_t least, const std::string& name) {
  if (values.size() < least) {
    throw ConfigError(name, std::to_string(values.size()) + " values",
                      "at least " + std::to_string(least));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(std::abs(values[i]) <= kLargestMagnitude)) {
      throw ConfigError(name + "[" + std::to_string(i) + "]", std::to_string(values[i]),
                        "a finite value of at most 1e100");
    }
  }
}

void require_inside_unit_interval(double value, const std::string& name) {
  if (!(value > 0.0 && value < 1.0)) {
    throw ConfigError(name, std::to_string(value), "a value between 0 and 1, both excluded");
  }
}

}  // namespace stillhand::statistics

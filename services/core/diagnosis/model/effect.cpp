// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/effect.hpp"

#include <algorithm>

namespace stillhand::diagnosis {

Parameter constant(std::string name, std::string unit, double value) {
  return {std::move(name), std::move(unit), value, value, value, false};
}

bool is_same(const Effect& one, const Effect& other) noexcept {
  return one.kind == other.kind && one.form == other.form && one.channels == other.channels;
}

std::size_t complexity(const Effect& effect) noexcept {
  if (!effect.is_whole()) return 0;
  const auto chosen = std::ranges::count_if(effect.parameters, [](const Parameter& parameter) {
    return parameter.lower < parameter.upper;
  });
  return effect.coefficients.size() + static_cast<std::size_t>(chosen);
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "services/core/cancellation/control_model.hpp"

namespace stillhand::cancellation {

/// A ValueMap of fixed size for the control path: the memoryless maps m_k of METHOD Eq. CC-6.
/// It trusts its map: check_model() comes first.
class ValueTable {
 public:
  static constexpr std::size_t kMostValues = 129;

  ValueTable() = default;
  explicit ValueTable(const ValueMap& map) noexcept : count_(map.values.size()) {
    if (count_ == 0) return;
    low_ = map.low;
    steps_per_unit_ = static_cast<double>(count_ - 1) / (map.high - map.low);
    std::copy(map.values.begin(), map.values.end(), values_.begin());
  }

  /// @param x  finite
  [[nodiscard]] double operator()(double x) const noexcept {
    if (count_ == 0) return x;
    const double place = (x - low_) * steps_per_unit_;
    const double last = static_cast<double>(count_ - 2);
    const auto i = static_cast<std::size_t>(std::clamp(place, 0.0, last));
    return values_[i] + (place - static_cast<double>(i)) * (values_[i + 1] - values_[i]);
  }

 private:
  std::array<double, kMostValues> values_{};
  std::size_t count_ = 0;
  double low_ = 0.0;
  double steps_per_unit_ = 0.0;
};

}  // namespace stillhand::cancellation

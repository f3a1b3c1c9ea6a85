// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/repeated_number.hpp"

#include <algorithm>

namespace stillhand::device_rig {
namespace {

constexpr Tick kStands_ticks = 200;

}  // namespace

void RepeatedNumber::step(double value, double motion) noexcept {
  const bool same = value == value_;
  value_ = value;
  ticks_ = same ? ticks_ + 1 : 0;
  lowest_ = same ? std::min(lowest_, motion) : motion;
  highest_ = same ? std::max(highest_, motion) : motion;
}

bool RepeatedNumber::repeats() const noexcept {
  return ticks_ >= kStands_ticks && highest_ - lowest_ >= least_motion_;
}

}  // namespace stillhand::device_rig

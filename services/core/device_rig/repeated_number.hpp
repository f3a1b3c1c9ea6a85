// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/tick.hpp"

namespace stillhand::device_rig {

/// A sensor that gives the same number again and again while the seat moves, METHOD Eq. DR-14: its
/// samples are young, and say nothing.
class RepeatedNumber {
 public:
  /// @param least_motion  [m/s^2] change of the seat's acceleration that no sensor misses
  explicit RepeatedNumber(double least_motion) noexcept : least_motion_(least_motion) {}

  /// One tick.
  /// @param value   of the sensor, in any unit; NaN is another number
  /// @param motion  [m/s^2] acceleration of the seat's set-point
  void step(double value, double motion) noexcept;

  [[nodiscard]] bool repeats() const noexcept;

 private:
  double least_motion_;
  double value_ = 0.0;
  double lowest_ = 0.0;  ///< [m/s^2] of the motion, since the number changed
  double highest_ = 0.0;
  Tick ticks_ = 0;  ///< for which the number stands
};

}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace stillhand::signal {

/// What an operator with memory keeps from one sample to the next.
struct HysteresisMemory {
  double state = 0.0;     ///< w, from -1 to 1
  double previous = 0.0;  ///< z of the sample before
  bool started = false;   ///< false: the next z is where it rests
};

/// Elastic and perfectly plastic element with limit 1, the "stop" operator, Eq. SG-19:
///
///   w(n) = clip(w(n-1) + z(n) - z(n-1), 1)
///
/// Hysteresis and, as z - w, play.  While z moves one way, the answer does not depend on how many
/// samples it takes.  Source: Visintin, Differential Models of Hysteresis, 1994.
/// @param z  in units of the threshold.  Pure; nothing allocates or throws.
inline double stop_operator(double z, HysteresisMemory& memory) noexcept {
  if (!memory.started) memory = {0.0, z, true};
  memory.state = std::clamp(memory.state + z - memory.previous, -1.0, 1.0);
  memory.previous = z;
  return memory.state;
}

/// Dahl's (1968) smooth relative, Eq. SG-20: dw = dz (1 - w sign(dz)).
inline double dahl_operator(double z, HysteresisMemory& memory) noexcept {
  if (!memory.started) memory = {0.0, z, true};
  const double change = z - memory.previous;
  // Exact over a step on which z moves one way: w tends to sign(dz) with e^-|dz|.
  const double towards = change >= 0.0 ? 1.0 : -1.0;
  memory.state = towards + (memory.state - towards) * std::exp(-std::abs(change));
  memory.previous = z;
  return memory.state;
}

/// The operators, by number for files and messages.
enum class HysteresisOperator : std::uint8_t { kStop, kDahl };

/// dw/dz at most: the stop's while it is elastic, Dahl's just after z turned at w = -1.
constexpr double steepest_slope(HysteresisOperator operation) noexcept {
  return operation == HysteresisOperator::kStop ? 1.0 : 2.0;
}

using HysteresisStep = double (*)(double z, HysteresisMemory& memory) noexcept;

constexpr HysteresisStep step_of(HysteresisOperator operation) noexcept {
  return operation == HysteresisOperator::kStop ? stop_operator : dahl_operator;
}

}  // namespace stillhand::signal

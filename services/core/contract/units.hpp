// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>

/// Factors between units.
namespace stillhand {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  ///< [rad] of a turn
inline constexpr double kNsPerS = 1e9;
inline constexpr double kNsPerMs = 1e6;

}  // namespace stillhand

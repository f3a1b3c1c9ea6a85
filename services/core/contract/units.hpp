// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <numbers>

/// Factors between units.
namespace stillhand {

inline constexpr double kTwoPi = 2.0 * std::numbers::pi;  ///< [rad] of a turn
inline constexpr double kNsPerS = 1e9;
inline constexpr double kNsPerMs = 1e6;
inline constexpr std::int64_t kSecond_ns = 1'000'000'000;
inline constexpr double kMmPerM = 1e3;
inline constexpr double kGravity_m_s2 = 9.80665;  ///< standard gravity: CGPM 1901

}  // namespace stillhand

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

#include "signal/difference_model.hpp"

namespace stillhand::cancellation {

/// Feedthrough model at the control rate.
using ControlRateModel = signal::DifferenceModel;

/// Why a model was not taken.
enum class Refusal : std::uint8_t {
  kNone,       ///< taken
  kMalformed,  ///< sizes differ, empty, d_0 not 1
  kNotFinite,  ///< a coefficient is NaN or infinite
  kWrongRate,  ///< not exactly 1000 Hz
  kOrder,      ///< above ModelFilter::kMaxOrder
  kUnstable,   ///< a pole on or outside the unit circle
  kSettling,   ///< slower than kMaxSettle_ticks to settle to 1 %
  kGain,       ///< |H| above the bound at some frequency
};
/// One line for a person.
std::string_view describe(Refusal refusal) noexcept;

/// Slowest transient that a model may have [ticks], to 1 %.  Feedthrough settles within a second;
/// 10 s leaves room for the slow pole of a model that was fitted to drift.
inline constexpr std::int64_t kMaxSettle_ticks = 10'000;

struct ModelCheck {
  Refusal refusal;
  std::int64_t settle_ticks;  ///< slowest pole's time to 1 %; 0 when refused
};

/// README Eq. CC-4.  Stability by the reflection coefficients (Eq. SG-13) and by the poles, which
/// fail differently when coefficients are ill conditioned; both must agree.  Gain at 0 Hz, at
/// 500 Hz, on 400 frequencies between and at each pole's own, so that no narrow peak is missed.
/// Never throws.
/// @param max_gain_n_s2_m  bound on |H|
ModelCheck check_model(const ControlRateModel& model, double max_gain_n_s2_m) noexcept;

}  // namespace stillhand::cancellation

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::cancellation {

/// Why a model was not taken.
enum class Refusal : std::uint8_t {
  kNone,        ///< taken
  kMalformed,   ///< sizes differ, empty, d_0 not 1, a table out of order
  kNotFinite,   ///< a number is NaN or infinite
  kWrongRate,   ///< not at the rate at which the canceller runs models, or too rich for it
  kOrder,       ///< above ControlModelFilter::kMaxOrder
  kUnstable,    ///< a pole on or outside the unit circle
  kSettling,    ///< slower than kMaxSettle_ticks to settle to 1 %
  kGain,        ///< |H| above the bound at some frequency
  kTooMany,     ///< more inputs, paths, waves, .. than ControlModelFilter has room for
  kPath,        ///< a further channel, a path next to the body or a wave above its bound
  kLoop,        ///< the spring inside the body: unstable at one of its slopes, or in a trial run
  kRest,        ///< a force above kMaxRest_n while nothing moves
  kCompliance,  ///< mass, damping, stiffness or lever of the hand out of range
};
/// One line for a person.
std::string_view describe(Refusal refusal) noexcept;
/// @throws ConfigError where the model was not taken, of what is named
void require_taken(Refusal refusal, const std::string& what, const std::string& want);

/// Slowest transient that a model may have [ticks], to 1 %.  Feedthrough settles within a second;
/// 10 s leaves room for the slow pole of a model that was fitted to drift.
inline constexpr std::int64_t kMaxSettle_ticks = 10'000;

/// Longest time that a spring may hold its phi [ticks]: a model of 5 Hz.
inline constexpr std::int64_t kMostHeld_ticks = 200;

/// [N] Feedthrough comes from motion: a model that pushes without motion is refused.
inline constexpr double kMaxRest_n = 1.0;

/// What a model may ask for at most; from the process's own settings.
struct ModelBounds {
  double max_gain_n_s2_m;   ///< |H| from an acceleration; from roll as much for each g it tips over
  double max_path_force_n;  ///< from theta, from omega at its full scale, of all waves, and at rest
  std::int64_t model_ticks = 1;  ///< from sample to sample of the model
};

struct ModelCheck {
  Refusal refusal;
  std::int64_t settle_ticks;  ///< slowest pole's time to 1 %; 0 when refused
};

/// Time until the slowest pole has fallen to 1 % [ticks of the model], CC-4; above kMaxSettle_ticks
/// where that is too long, or never.
std::int64_t settle_ticks(const signal::DifferenceModel& model);

/// Whether mass, damping, stiffness and lever are those of an arm on a stick, CC-14.
bool is_hand(const HandCompliance& hand) noexcept;

/// Checks a control model, METHOD Eq. CC-4 and CC-14.  Stability is judged by the reflection
/// coefficients (services/core/signal, Eq. SG-13) and by the poles, which fail differently when
/// coefficients are ill conditioned; both must agree.  The gain is judged at 0 Hz, at 500 Hz, on
/// 400 frequencies between and at each pole's own, so that no narrow peak is missed.  A spring
/// inside the body must be stable with each of its slopes, and a trial run through the motion's
/// band must stay bounded and die away.  Never throws.  Takes up to some milliseconds.
ModelCheck check_model(const ControlModel& model, const ModelBounds& bounds) noexcept;

}  // namespace stillhand::cancellation

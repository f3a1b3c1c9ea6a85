// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

namespace stillhand::session {

/// A force [N] with its 95 % interval.
struct ForceEstimate {
  double force_n = 0.0;
  double low_n = 0.0;
  double high_n = 0.0;
};

/// What is left of the feedthrough in a trial with cancellation, and its causes.  They add up to
/// it; a cause that cancels another one is negative.  README Eq. SN-8.
struct ForceBudget {
  ForceEstimate left;         ///< RMS(f' + f_m), Eq. SN-4
  ForceEstimate model;        ///< what the model does not predict
  ForceEstimate lateness;     ///< samples lost on the way, answers that came late or not
  ForceEstimate limits;       ///< force and slew limits, ramps and fades
  ForceEstimate involuntary;  ///< what no linear filter of the motion explains
  ForceEstimate sensor;       ///< noise and steps of the accelerometer
};

/// A cause, for tables and files.
struct ForceCause {
  const char* key;      ///< in summary.json
  const char* meaning;  ///< for a page
  ForceEstimate ForceBudget::* of;
};
inline constexpr std::array<ForceCause, 5> kForceCauses{{
    {"model", "the model predicts another force", &ForceBudget::model},
    {"lateness", "samples and answers were late, or lost", &ForceBudget::lateness},
    {"limits", "limits of force and slew, ramps and fades", &ForceBudget::limits},
    {"involuntary", "the body's own force, not a linear response to the motion",
     &ForceBudget::involuntary},
    {"sensor", "noise and steps of the accelerometer", &ForceBudget::sensor},
}};

/// The motor's force in a tick, as it would have been.
struct AskedForces {
  double on_time_n = 0.0;    ///< had every sample been answered in its tick, f_o
  double unlimited_n = 0.0;  ///< the same without limits, f_u
  double noiseless_n = 0.0;  ///< the same from the true acceleration, f_t
};

/// Forces of a tick.
struct TickForces {
  double feedthrough_n = 0.0;  ///< f'
  double motor_n = 0.0;        ///< f_m, as applied
  AskedForces asked;
};

/// Sums over ticks of a trial.  They may be taken while it runs: the parts so far add up to what is
/// left so far.
struct ForceSums {
  double ticks = 0.0;
  double left = 0.0;  ///< [N^2] of f' + f_m: its square
  /// [N^2] of its products with the part that is late, limited, of the sensor, and with the rest
  double lateness = 0.0, limits = 0.0, sensor = 0.0, rest = 0.0;

  ForceSums& operator+=(const ForceSums& other) noexcept;
  /// [N] What a sum of products is of RMS(f' + f_m), README Eq. SN-8; 0 of nothing.
  [[nodiscard]] double force_n(double products) const noexcept;
};
/// Of one tick.
ForceSums sums_of(const TickForces& forces) noexcept;

/// Forces of a trial and the motion behind them, 1 kHz over the measured ticks; equally long.
struct BudgetSignals {
  std::vector<TickForces> forces;
  std::vector<std::vector<double>> motion;  ///< channels that f' may follow, any unit
};

/// README Eq. SN-8 to SN-10.  Pure.
/// @returns nothing for trials shorter than 12 s, or when a force is unknown
std::optional<ForceBudget> force_budget(const BudgetSignals& signals);

}  // namespace stillhand::session

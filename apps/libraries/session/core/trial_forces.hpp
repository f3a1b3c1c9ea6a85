// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace stillhand::session {

/// Root mean square; 0 of nothing.
double rms(std::span<const double> values) noexcept;

/// Forces and motion of the hand over the measured ticks of a trial, from the truth of the rig.
/// All vectors are equally long.
struct ForceSignals {
  std::vector<double> feedthrough_n;  ///< f', of the body on a held stick
  std::vector<double> motor_n;        ///< f_m, as applied
  std::vector<double> volitional_n;   ///< f_t, as applied
  std::vector<double> hand_m_s;       ///< velocity of the hand
};

/// What is left of the feedthrough, and what it costs; README Eq. SN-4 to SN-6.
struct TrialForces {
  double left_n = 0.0;             ///< [N] RMS(f' + f_m)
  double acceleration_m_s2 = 0.0;  ///< [m/s^2] RMS of the hand's acceleration
  double motor_n = 0.0;            ///< [N] RMS(f_m)
  double volitional_n = 0.0;       ///< [N] RMS(f_t)
};

/// README Eq. SN-4 to SN-6.  Pure.
/// @param rate_hz  [Hz] of the signals, a multiple of 100 Hz
TrialForces trial_forces(const ForceSignals& signals, double rate_hz);

}  // namespace stillhand::session

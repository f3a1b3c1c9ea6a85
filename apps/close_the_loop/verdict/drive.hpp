// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "services/core/diagnosis/diagnose.hpp"
#include "services/core/recording/recording.hpp"
#include "services/core/rig/parts/body_config.hpp"
#include "services/core/rig/parts/motor.hpp"

namespace stillhand::close_the_loop {

/// The lab's stick and motor by their data sheets and the rig's settings.
struct DeclaredDrive {
  rig::StickConfig stick;
  /// [s] From the answered sample to the next one, and the current loop's lag.
  double motor_delay_s = 0.0025;
};

/// Delay between the commanded and the felt force, METHOD Eq. CL-5:
///
///   f(t) = m lever alpha(t - c) + b lever omega(t - c) + F sign(omega)(t - c) - k f_m(t - m - c)
///
/// f the load cell, f_m the motor command, c the cell's delay and m the motor's; the better of
/// "only the motor is late" and "only the cell is late".
struct Latency {
  double motor_s = 0.0;      ///< [s] from command to force
  double cell_s = 0.0;       ///< [s] from force to reading
  double explained_n = 0.0;  ///< RMS that the delay explains beyond the declared one
  double residual_n = 0.0;   ///< RMS left
};

/// @param trial  a tracking trial with the motor acting, 1 kHz: theta, f, f_motor
/// @return nothing when the motor was almost idle
std::optional<Latency> measure_latency(const recording::Recording& trial,
                                       const DeclaredDrive& declared);

/// The stick's own equation as a measurement: what the hand needs to move it beyond what is
/// declared, f + f_m - declared friction, from alpha and omega; for `--model linear`.  100 Hz.
diagnosis::Measurement drive_measurement(const recording::Recording& trial,
                                         const DeclaredDrive& declared);

/// Diagnoses it, over all trials together: friction and ripple that are not declared.  An effect
/// counts from options.least_force_n on, and from the declared friction on: a data sheet's friction
/// is not known better than to itself.
diagnosis::Diagnosis diagnose_drive(const std::vector<const recording::Recording*>& trials,
                                    const DeclaredDrive& declared,
                                    const diagnosis::DiagnoseOptions& options);

}  // namespace stillhand::close_the_loop

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "services/core/admittance/interleaved_multisines.hpp"
#include "services/core/admittance/line_responses.hpp"

/// An arm on a free stick in the time domain, and its responses in closed form: the judge of
/// services/core/admittance.  Shares no formula with it: matrices of three masses, here eliminated
/// by Eigen, stepped by Runge and Kutta.
namespace stillhand::simulated {

/// m_t c_t k_t m_a c_a k_a m_h c_h k_h k_r tau.
using Values = std::array<double, 11>;

/// Arm `index` of a seed: a tracking subject of services/core/population (Eq. SU-1), and a reflex
/// drawn uniformly from 100 to 400 N/m and 25 to 40 ms (ranges of services/processes/rig, "What a
/// person adds").
Values drawn_arm(std::uint64_t seed, std::int64_t index);

/// X/F_m, F/F_m, X/A, F/A and -X/F at one frequency.
struct Truth {
  std::complex<double> x_per_force, f_per_force, x_per_accel, f_per_accel, admittance;
};
Truth truth_at(const Values& arm, double frequency_hz);

/// Noise of a record.  The hand's own force is a first-order noise; it moves the stick.
struct Noise {
  double hand_force_n = 0.4;        ///< RMS, corner 2 Hz; services/processes/rig, RG-31
  double displacement_m = 4.4e-5;   ///< 4096 counts a turn at 0.10 m, over the root of 12
  double force_n = 0.05;            ///< of the load cell
  double acceleration_m_s2 = 0.01;  ///< of the accelerometer
};

/// What one run holds.
struct Run {
  admittance::FreeStickRecord record;
  double largest_force_n = 0.0;  ///< of the motor, at the half steps
  double largest_acceleration_m_s2 = 0.0;
};

/// `periods` periods after one that is left out, by fourth-order Runge and Kutta with half the
/// sampling time.
Run run(const Values& arm, const admittance::Excitation& excitation, double rate_hz,
        std::int64_t periods, const Noise& noise, std::uint64_t seed);

}  // namespace stillhand::simulated

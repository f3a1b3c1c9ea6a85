// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "services/core/admittance/interleaved_multisines.hpp"

namespace stillhand::admittance {

/// Whole periods of a free stick in steady state, without gaps.  Frame and signs of
/// services/processes/rig:
/// + right, forces and displacement at the hand, displacement relative to the platform.
struct FreeStickRecord {
  double rate_hz = 1000.0;
  std::vector<double> motor_force_n;      ///< f_m [N] of the motor on the stick
  std::vector<double> acceleration_m_s2;  ///< a [m/s^2] of the platform
  std::vector<double> displacement_m;     ///< x [m] of the stick, lever times angle
  std::vector<double> hand_force_n;       ///< f [N] of the hand on the stick (load cell)
};

/// A frequency response at one line with its uncertainty.
struct LineResponse {
  double frequency_hz = 0.0;
  std::complex<double> response;  ///< R
  double variance = 0.0;          ///< E|R - truth|^2, Eq. AD-6
  double radius95 = 0.0;          ///< of the circle about R that holds the truth in 95 %, Eq. AD-7
  double coherence = 0.0;         ///< [-] of the output over one period, Eq. AD-8
};

/// What one record says at the excited lines.
struct LineEstimates {
  std::vector<LineResponse> admittance;               ///< -X/F [m/N], the arm alone, force lines
  std::vector<LineResponse> stick_per_force;          ///< X/F_m [m/N], arm and stick, force lines
  std::vector<LineResponse> feedthrough_to_force;     ///< F/A [N s^2/m], stick free, motion lines
  std::vector<LineResponse> feedthrough_to_position;  ///< X/A [s^2], stick free, motion lines
  /// E[(X/A - truth) conj(F/A - truth)] [s^2 * N s^2/m]: the two share the hand's own force
  std::vector<std::complex<double>> position_force_covariance;
  std::int64_t neighbours = 0;  ///< nu [-] unexcited lines at each line: complex degrees of freedom
};

/// Responses at the lines of a record of P periods, Eqs. AD-4 to AD-8:
///
///   X_k = 2/N sum x[n] exp(-2 pi j k P n / N),   R = Y_k / U_k,
///   C = 1/nu sum_j |e_j|^2,  e_j = (Y_kj - R U_kj) / U_k,   kj = k P -+ 1 .. (P - 1)
///
/// The lines kj of the whole record lie between the lines of the period, so no excitation and no
/// nonlinearity that repeats with it reaches them: they hold the noise.
/// Source: README; Pintelon and Schoukens, System Identification: A Frequency Domain Approach.
/// Pure.
/// @throws stillhand::ConfigError when signals differ in length or are not finite, or the record
///         is not a whole number of periods, four or more.
LineEstimates estimate(const FreeStickRecord& record, const Excitation& excitation);

/// Feedthrough to force of a pegged stick, F/A [N s^2/m] at the motion lines, Eqs. AD-4 to AD-8.
/// @param record  displacement and motor force are not used; same lengths and conditions as above
std::vector<LineResponse> estimate_pegged(const FreeStickRecord& record,
                                          const Excitation& excitation);

}  // namespace stillhand::admittance

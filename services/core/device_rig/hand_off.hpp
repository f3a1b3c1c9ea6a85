// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

namespace stillhand::device_rig {

/// What was seen with the hand off, METHOD Eq. DR-19.  Each function gives what is wrong, in words
/// for the person at the rig; empty: it is right.  Pure.

/// Angle at both stops, + right.  @param stop_rad  of the settings
std::string travel_fault(double right_rad, double left_rad, double stop_rad);

/// Force that a known weight adds.  @param known_n  above 0
std::string weight_fault(double read_n, double known_n);

/// A push of the motor and what it did.
struct Push {
  double asked_n = 0.0;     ///< largest force that the drive was asked for; + right
  double measured_n = 0.0;  ///< that the drive measured then
  double moved_m = 0.0;     ///< of the hand's place, + right
};
/// @param least_m  motion that counts
std::string push_fault(const Push& push, double least_m);

/// A step of the platform, and the accelerometer during it.
struct Stroke {
  double asked_m = 0.0, moved_m = 0.0;
  double seat_gain = 0.0;  ///< of stroke_gain()
  bool seat_seen = false;  ///< the accelerometer is a device
};
std::string stroke_fault(const Stroke& stroke);

/// Reading over acceleration of the set-point: least squares at the delay, up to `most_lag`
/// samples, at which both are most alike in size, whatever the sign.
double stroke_gain(std::span<const double> asked_m_s2, std::span<const double> read_m_s2,
                   std::size_t most_lag);

}  // namespace stillhand::device_rig

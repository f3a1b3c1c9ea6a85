// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/hand_off.hpp"

#include <fmt/format.h>

#include <cmath>

namespace stillhand::device_rig {
namespace {

// Our own choice: signs, wrong units, factors of two and slipped ratios show; a calibration is
// finer.
constexpr double kTravelShare = 0.1;
constexpr double kWeightShare = 0.3;
constexpr double kTorqueShare = 0.5;
constexpr double kStrokeShare = 0.2;
constexpr double kSeatShare = 0.5;

bool within(double value, double wanted, double share) {
  return std::abs(value - wanted) <= share * std::abs(wanted);
}

}  // namespace

std::string travel_fault(double right_rad, double left_rad, double stop_rad) {
  if (right_rad < 0.0 && left_rad > 0.0) {
    return "the angle is negative at the right stop: change drive.angle_sign";
  }
  if (!within(right_rad, stop_rad, kTravelShare) || !within(left_rad, -stop_rad, kTravelShare)) {
    return fmt::format(
        "the stops are at {:+.3f} and {:+.3f} rad, and stick.stop_angle_rad of rig.yaml is {:.3f}: "
        "another zero (stillhand calibrate angle), another ratio, or not the stops",
        right_rad, left_rad, stop_rad);
  }
  return {};
}

std::string weight_fault(double read_n, double known_n) {
  if (read_n < -0.1 * known_n) {
    return fmt::format("a pull of {:.2f} N to the right reads {:+.2f} N: the sign is wrong",
                       known_n, read_n);
  }
  if (!within(read_n, known_n, kWeightShare)) {
    return fmt::format("a pull of {:.2f} N reads {:+.2f} N: another weight, or another calibration",
                       known_n, read_n);
  }
  return {};
}

std::string push_fault(const Push& push, double least_m) {
  const char* side = push.asked_n > 0.0 ? "right" : "left";
  const double along_m = push.asked_n > 0.0 ? push.moved_m : -push.moved_m;
  if (along_m <= -least_m) {
    return fmt::format(
        "a push to the {} moves the stick the other way: change drive.torque_sign (or angle_sign, "
        "if the angle at the stops was wrong)",
        side);
  }
  if (!(along_m >= least_m)) {
    return fmt::format(
        "{:+.2f} N to the {} moved the stick by {:.2g} mm, less than {:.2g}: it is held, its "
        "friction is larger, or the torque is smaller than it should be",
        push.asked_n, side, 1e3 * along_m, 1e3 * least_m);
  }
  if (!within(push.measured_n, push.asked_n, kTorqueShare)) {
    return fmt::format(
        "the drive was asked for {:+.2f} N and measured {:+.2f} N: torque constant, "
        "ratio or stick.lever_m",
        push.asked_n, push.measured_n);
  }
  return {};
}

std::string stroke_fault(const Stroke& stroke) {
  if (!within(stroke.moved_m, stroke.asked_m, kStrokeShare)) {
    return fmt::format(
        "the platform moved by {:+.2f} mm for a step of {:+.2f} mm: its sign or scale",
        1e3 * stroke.moved_m, 1e3 * stroke.asked_m);
  }
  if (!stroke.seat_seen) return {};
  if (stroke.seat_gain <= -kSeatShare) {
    return "the accelerometer moves against the platform: turn it, or change its sign";
  }
  if (!within(stroke.seat_gain, 1.0, kSeatShare)) {
    return fmt::format(
        "the accelerometer reads {:.2f} of the set-point's acceleration: another calibration, or a "
        "platform that does not follow",
        stroke.seat_gain);
  }
  return {};
}

double stroke_gain(std::span<const double> asked_m_s2, std::span<const double> read_m_s2,
                   std::size_t most_lag) {
  double mean = 0.0;
  for (const double each : read_m_s2) mean += each / static_cast<double>(read_m_s2.size());
  double best = 0.0;
  double gain = 0.0;
  for (std::size_t lag = 0; lag <= most_lag && lag < asked_m_s2.size(); ++lag) {
    double s_xy = 0.0;
    double s_xx = 0.0;
    for (std::size_t i = lag; i < read_m_s2.size(); ++i) {
      const double x = asked_m_s2[i - lag];
      s_xy += x * (read_m_s2[i] - mean);
      s_xx += x * x;
    }
    if (s_xx <= 0.0 || std::abs(s_xy) <= best) continue;
    best = std::abs(s_xy);
    gain = s_xy / s_xx;
  }
  return gain;
}

}  // namespace stillhand::device_rig

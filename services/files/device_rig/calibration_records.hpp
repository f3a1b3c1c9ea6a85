// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/contract/config_field.hpp"

namespace stillhand::device_rig {

inline constexpr Range kAnyNumber{-1e12, 1e12};

/// Lag and bandwidth of a platform, Eq. DR-18; written by `stillhand calibrate platform`.
struct PlatformRecord {
  std::string date;  ///< YYYY-MM-DD; empty: never
  std::string person;
  std::string device;  ///< DevicePlant::platform_device()
  double lag_s = 0.0, lag_error_s = 0.0;
  double bandwidth_hz = 0.0, bandwidth_error_hz = 0.0;
  bool bandwidth_seen = false;
  double gain = 0.0, gain_error = 0.0;
  double seat_gain = 0.0, seat_gain_error = 0.0;
  double motion_m = 0.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("date", self.date, Range{0.0, 10.0}, "day of the identification, YYYY-MM-DD");
    visit("person", self.person, Range{0.0, 100.0}, "who did it");
    visit("device", self.device, Range{0.0, 300.0}, "platform that was moved");
    visit("lag_s", self.lag_s, kAnyNumber, "[s] from set-point to state, 0.5 to 4 Hz");
    visit("lag_error_s", self.lag_error_s, kAnyNumber, "[s] standard error of lag_s");
    visit("bandwidth_hz", self.bandwidth_hz, kAnyNumber, "[Hz] where the state has 0.71 of it");
    visit("bandwidth_error_hz", self.bandwidth_error_hz, kAnyNumber, "[Hz] its standard error");
    visit("bandwidth_seen", self.bandwidth_seen, Range{0.0, 1.0},
          "[-] false: it is beyond bandwidth_hz");
    visit("gain", self.gain, kAnyNumber, "[-] state over set-point at 0.5 Hz");
    visit("gain_error", self.gain_error, kAnyNumber, "[-] standard error of gain");
    visit("seat_gain", self.seat_gain, kAnyNumber,
          "[-] accelerometer over the acceleration of the state; 0: not measured");
    visit("seat_gain_error", self.seat_gain_error, kAnyNumber, "[-] standard error of seat_gain");
    visit("motion_m", self.motion_m, kAnyNumber, "[m] largest distance of the motion");
  }
};

/// The check of signs, scales and travel with the hand off, Eq. DR-19; written by `stillhand
/// calibrate check`.  0: not measured, since that part is simulated.
struct HandOffRecord {
  std::string date;
  std::string person;
  std::string devices;  ///< DevicePlant::pushing_devices()
  double right_stop_rad = 0.0, left_stop_rad = 0.0;
  double force_gain = 0.0;
  double pushed_right_m = 0.0, pushed_left_m = 0.0;
  double torque_gain = 0.0;
  double platform_gain = 0.0;
  double seat_gain = 0.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("date", self.date, Range{0.0, 10.0}, "day of the check, YYYY-MM-DD");
    visit("person", self.person, Range{0.0, 100.0}, "who did it");
    visit("devices", self.devices, Range{0.0, 1000.0}, "devices that were checked");
    visit("right_stop_rad", self.right_stop_rad, kAnyNumber, "[rad] angle at the right stop");
    visit("left_stop_rad", self.left_stop_rad, kAnyNumber, "[rad] angle at the left stop");
    visit("force_gain", self.force_gain, kAnyNumber, "[-] force read over the weight's");
    visit("pushed_right_m", self.pushed_right_m, kAnyNumber, "[m] the motor's push to the right");
    visit("pushed_left_m", self.pushed_left_m, kAnyNumber, "[m] the motor's push to the left");
    visit("torque_gain", self.torque_gain, kAnyNumber,
          "[-] torque that the drive measures over the one it was asked for");
    visit("platform_gain", self.platform_gain, kAnyNumber,
          "[-] step of the platform over the asked");
    visit("seat_gain", self.seat_gain, kAnyNumber, "[-] acceleration read over the set-point's");
  }
};

}  // namespace stillhand::device_rig

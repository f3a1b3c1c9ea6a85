// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "services/core/contract/config_field.hpp"

namespace stillhand::device_rig {

/// Which part serves which signal.
struct SignalsConfig {
  std::string acceleration = "simulated";
  std::string force = "simulated";
  std::string angle = "simulated";
  std::string motor = "simulated";
  std::string platform = "simulated";

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("acceleration", self.acceleration, Range{1.0, 20.0},
          "lateral acceleration: simulated, drive (an analogue input of it), platform or iio");
    visit("force", self.force, Range{1.0, 20.0},
          "force of the hand on the stick: simulated, drive (an analogue input of it) or iio");
    visit("angle", self.angle, Range{1.0, 20.0}, "angle of the stick: simulated or drive");
    visit("motor", self.motor, Range{1.0, 20.0},
          "the stick's motor: simulated, drive, or off (a drive whose power stage stays off)");
    visit("platform", self.platform, Range{1.0, 20.0},
          "motion platform: simulated, plain_udp or moog_udp");
  }
};

/// The servo drive of the stick: a moteus behind an fdcanusb, a UART or a CAN interface.
struct DriveConfig {
  std::string kind = "moteus";
  std::string port = "/dev/fdcanusb";
  std::int64_t id = 1;
  bool checksum = false;
  std::int64_t period_ticks = 1;
  double watchdog_s = 0.02;
  std::int64_t max_age_ticks = 10;
  double max_torque_n_m = 2.5;
  double max_current_a = 10.0;
  std::int64_t torque_sign = 1;
  std::int64_t angle_sign = 1;
  std::int64_t counts_per_rev = 4096;
  double max_rate_rad_s = 60.0;
  double analogue_v = 3.3;
  std::int64_t force_input = 1;
  std::int64_t acceleration_input = 2;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("kind", self.kind, Range{1.0, 20.0},
          "what it is: moteus (serial port) or moteus_can (a CAN interface of the kernel)");
    visit("port", self.port, Range{1.0, 200.0},
          "serial port of the adapter or of the drive's UART, or the CAN interface (can0)");
    visit("id", self.id, Range{1.0, 127.0}, "[-] number of a moteus on its bus");
    visit("checksum", self.checksum, Range{0.0, 1.0},
          "every line has a checksum; a moteus's UART always answers with one");
    visit("period_ticks", self.period_ticks, Range{1.0, 10.0},
          "[ticks] one exchange each so many ticks; as fast as the transport carries");
    visit("watchdog_s", self.watchdog_s, Range{0.005, 0.1},
          "[s] the drive switches off by itself when no command came for so long");
    visit("max_age_ticks", self.max_age_ticks, Range{2.0, 100.0},
          "[ticks] oldest reply that counts");
    visit("max_torque_n_m", self.max_torque_n_m, Range{0.0, 30.0},
          "[N m] largest torque of a command; a bound of the drive, too");
    visit("max_current_a", self.max_current_a, Range{0.1, 100.0},
          "[A] largest current limit of the drive; a drive with more is refused");
    visit("torque_sign", self.torque_sign, Range{-1.0, 1.0},
          "[-] 1: a positive torque pushes the hand to the right; -1: to the left");
    visit("angle_sign", self.angle_sign, Range{-1.0, 1.0},
          "[-] 1: the drive's position grows to the right; -1: to the left");
    visit(
        "counts_per_rev", self.counts_per_rev, Range{64.0, 10000000.0},
        "[counts/rev] the angle goes out in these; the same as encoder_counts_per_rev of sensing");
    visit("max_rate_rad_s", self.max_rate_rad_s, Range{1.0, 1000.0},
          "[rad/s] no hand moves the stick faster; a faster step is an encoder's fault");
    visit("analogue_v", self.analogue_v, Range{0.1, 24.0},
          "[V] voltage at which an analogue input of the drive reads 1");
    visit("force_input", self.force_input, Range{1.0, 2.0},
          "[-] connector of the load cell's amplifier: 1 AUX1, 2 AUX2, first pin");
    visit("acceleration_input", self.acceleration_input, Range{1.0, 2.0},
          "[-] connector of the accelerometer: 1 AUX1, 2 AUX2, first pin");
  }
};

/// A platform that takes set-points by UDP.
struct PlatformLinkConfig {
  std::string address = "127.0.0.1";
  std::int64_t port = 16991;
  std::int64_t local_port = 0;
  std::int64_t period_ticks = 1;
  std::int64_t valid_ms = 20;
  std::int64_t max_age_ticks = 50;
  double max_jerk_m_s3 = 1000.0;
  double heave_m = 0.0;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("address", self.address, Range{7.0, 15.0}, "IPv4 address of the platform's controller");
    visit("port", self.port, Range{1.0, 65535.0}, "[-] UDP port there");
    visit("local_port", self.local_port, Range{0.0, 65535.0},
          "[-] UDP port here; 0: any that is free");
    visit("period_ticks", self.period_ticks, Range{1.0, 50.0},
          "[ticks] one set-point each so many ticks; a platform of 60 Hz takes 16");
    visit("valid_ms", self.valid_ms, Range{2.0, 1000.0},
          "[ms] the platform brakes when no set-point came for so long (plain_udp)");
    visit("max_age_ticks", self.max_age_ticks, Range{2.0, 1000.0},
          "[ticks] oldest state of the platform that counts");
    visit("max_jerk_m_s3", self.max_jerk_m_s3, Range{10.0, 100000.0},
          "[m/s^3] fastest change of the set-point's acceleration; the wall may demand more");
    visit("heave_m", self.heave_m, Range{-2.0, 2.0},
          "[m] height at which the platform works (moog_udp)");
  }
};

/// A channel of an IIO device: an accelerometer, or the bridge converter of a load cell.
struct IioConfig {
  std::string uri = "local:";
  std::string device;
  std::string channel;
  std::int64_t sign = 1;
  std::int64_t max_age_ticks = 10;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("uri", self.uri, Range{4.0, 200.0},
          "context of libiio: local:, or ip: and the address of a machine with iiod");
    visit("device", self.device, Range{1.0, 100.0}, "name or id of the IIO device");
    visit("channel", self.channel, Range{1.0, 100.0}, "id of its input channel");
    visit("sign", self.sign, Range{-1.0, 1.0}, "[-] 1: positive is to the right; -1: to the left");
    visit("max_age_ticks", self.max_age_ticks, Range{2.0, 100.0},
          "[ticks] oldest sample that counts");
  }
};

/// An accelerometer of one axis, or of three that sit on the platform as `mount` says.
struct AccelerometerConfig : IioConfig {
  std::string mount;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    IioConfig::fields(visit, self);
    visit("mount", self.mount, Range{0.0, 200.0},
          "of three axes: the directions forward, right and up in those of its channels accel_x, "
          "accel_y, accel_z, nine numbers row by row; empty: `channel` alone is read");
  }
};

/// What a session asks of the calibration of its devices.
struct CalibrationRule {
  std::int64_t max_age_days = 90;
  std::int64_t check_max_age_days = 1;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("max_age_days", self.max_age_days, Range{0.0, 3650.0},
          "[days] oldest calibration (stillhand calibrate) of a device; 0: none is asked for");
    visit("check_max_age_days", self.check_max_age_days, Range{0.0, 3650.0},
          "[days] oldest check with the hand off (stillhand calibrate check) before the drive "
          "pushes; 0, or max_age_days 0: none is asked for");
  }
};

/// The rig made of devices: devices.yaml.
struct DevicesConfig {
  SignalsConfig signals;
  DriveConfig drive;
  PlatformLinkConfig platform;
  AccelerometerConfig accelerometer{{.device = "accelerometer", .channel = "accel_y"}, ""};
  IioConfig load_cell{.device = "bridge", .channel = "voltage0"};
  CalibrationRule calibration;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("signals", self.signals);
    visit.group("drive", self.drive);
    visit.group("platform", self.platform);
    visit.group("accelerometer", self.accelerometer);
    visit.group("load_cell", self.load_cell);
    visit.group("calibration", self.calibration);
  }
};

}  // namespace stillhand::device_rig

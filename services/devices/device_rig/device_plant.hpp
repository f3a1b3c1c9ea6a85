// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/core/device_rig/arming.hpp"
#include "services/core/device_rig/mount.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/core/device_rig/repeated_number.hpp"
#include "services/core/device_rig/same_side.hpp"
#include "services/core/rig/plant.hpp"
#include "services/core/signal/delay_line.hpp"
#include "services/devices/device_rig/drive_link.hpp"
#include "services/devices/device_rig/iio_link.hpp"
#include "services/devices/device_rig/platform_drive.hpp"
#include "services/devices/device_rig/platform_link.hpp"
#include "services/files/device_rig/calibration_file.hpp"

namespace stillhand::device_rig {

/// The platform of the settings, as a calibration names it; empty: it is simulated.
std::string platform_device(const DevicesConfig& devices);

/// A sample that no device has put anything into.
rig::RawSample untouched() noexcept;
/// The signal of a device that is still untouched(); nullptr: every one was put.
const char* unserved(const Parts& parts, const rig::RawSample& raw) noexcept;

/// The rig made of devices: settings say which part serves which signal; the simulated rig serves
/// the rest.  Each tick takes the newest sample of each device and gives it one demand; the links
/// do the talking.  METHOD Eq. DR-3 to DR-11, DR-20 to DR-24.
class DevicePlant final : public rig::Plant {
 public:
  /// Opens and checks every device, and that each signal of a device is published: the simulated
  /// one never goes out under a device's name.
  /// @throws ConfigError for settings that do not fit, or a device that is missing or refused
  /// @param platform_lag_s  of the platform, Eq. DR-18; 0: not known
  DevicePlant(const rig::RigConfig& rig, const DevicesConfig& devices, double platform_lag_s = 0.0);

  void wait() noexcept override;
  void begin(const Trial& trial, Tick tick) noexcept override;
  rig::RigOutput step(const rig::RigInput& input) noexcept override;
  rig::RigOutput sample(const rig::RigInput& input) noexcept override;
  void drive(const rig::RigInput& input, rig::RigOutput& output) noexcept override;
  [[nodiscard]] bool prepared() const noexcept override;
  [[nodiscard]] const char* unsound() const noexcept override { return why_; }
  [[nodiscard]] const char* notice() noexcept override { return std::exchange(notice_, nullptr); }
  [[nodiscard]] const char* parts() const noexcept override { return words_.c_str(); }
  /// The device that measures a signal, with its serial number; empty: the signal is simulated.
  [[nodiscard]] std::string device_of(CalibratedSignal signal) const;
  /// The platform; empty: it is simulated.
  [[nodiscard]] std::string platform_device() const {
    return device_rig::platform_device(devices_);
  }
  /// All that the check with the hand off is of; empty where no drive pushes.
  [[nodiscard]] std::string pushing_devices() const;
  /// What the devices' threads counted, a line for each that has something to say.
  [[nodiscard]] std::vector<std::string> counts();
  /// Torque that the drive measures, as a force at the hand, + right [N]; NaN: unknown.
  [[nodiscard]] double measured_force_n() const noexcept;

 private:
  void take_drive() noexcept;
  void take_platform() noexcept;
  void take_iio() noexcept;
  void refuse_unserved() const;
  void put_devices(rig::RigOutput& output) const noexcept;
  void put_stick(rig::RigOutput& output) const noexcept;
  void put_platform(rig::RigOutput& output) const noexcept;
  void put_iio(rig::RigOutput& output) const noexcept;
  void put_motor(rig::RigOutput& output) const noexcept;
  [[nodiscard]] MotionLeave leave_of(const rig::RigInput& input) const noexcept;
  /// @param turn  of an exchange
  PlatformDrive::Output move_platform(const rig::RigInput& input, bool turn) noexcept;
  void drive_motor(const rig::RigInput& input, rig::RigOutput& output) noexcept;
  void watch_numbers(const rig::RigInput& input, const rig::RigOutput& output) noexcept;
  void judge() noexcept;
  void judge_platform() noexcept;
  [[nodiscard]] const char* unknown_iio() noexcept;
  [[nodiscard]] bool at_rail() const noexcept;
  [[nodiscard]] bool drive_fresh() const noexcept;
  [[nodiscard]] bool platform_fresh() const noexcept;
  /// NaN: no young sample, or one at an end of the converter's range (DR-12).
  [[nodiscard]] double iio_value(IioLink& link, const IioConfig& config) noexcept;
  void take_accelerometer() noexcept;

  static constexpr double kNothingYet = std::numeric_limits<double>::quiet_NaN();

  rig::RigConfig rig_config_;
  DevicesConfig devices_;
  Parts parts_;
  rig::Rig simulated_;
  rig::Motor motor_;  ///< age, permission and envelope of the force: those of the simulated rig
  PlatformDrive seat_drive_;
  Arming arming_;
  std::unique_ptr<IioLink> accelerometer_;
  std::optional<Mount> mount_;  ///< of an accelerometer of three axes
  std::unique_ptr<IioLink> load_cell_;
  // Last of the links, so first to go: the end of another one may wait for its network.
  std::unique_ptr<DriveLink> drive_;  ///< null: no part is the drive's
  std::unique_ptr<PlatformLink> platform_;

  Trial trial_;
  Tick tick_ = 0;
  std::int64_t now_ns_ = 0;
  DriveSample stick_;
  PlatformSample seat_;
  PlatformOrder asked_order_ = PlatformOrder::kHold;  ///< of the newest set-point
  double accel_y_m_s2_ = kNothingYet;                 ///< of the accelerometer; NaN: unknown
  double accel_x_m_s2_ = 0.0, accel_z_m_s2_ = 0.0;    ///< 0 of an accelerometer of one axis
  double load_cell_v_ = kNothingYet;                  ///< NaN: unknown
  RepeatedNumber acceleration_{0.5};  ///< a 12-bit converter over 3 g has steps of 0.014 m/s^2
  SameSide side_;                     ///< of the accelerometer, over a trial
  signal::DelayLine asked_;           ///< acceleration of the set-point, as late as the platform
  RepeatedNumber force_{2.0};         ///< a free stick moves a load cell by its own 0.2 kg, 0.4 N
  Tick unknown_ticks_ = 0;            ///< one of the two is unknown for so long
  bool jumped_ = false;               ///< the angle jumped; until this process is started again
  Tick rail_ticks_ = 0;               ///< an analogue input stands at its end for so long
  double force_n_ = 0.0;              ///< as the drive was ordered
  Flags motor_flags_ = kGood;         ///< of that force
  Order order_ = Order::kQuery;
  const char* why_ = nullptr;
  const char* notice_ = nullptr;
  std::array<char, 120> text_{}, platform_text_{}, notice_text_{};
  std::string words_;
};

}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/core/contract/config_field.hpp"
#include "services/core/device_rig/calibration_fit.hpp"
#include "services/core/device_rig/devices_config.hpp"
#include "services/core/sensing/conditioner.hpp"
#include "services/files/device_rig/calibration_records.hpp"

namespace stillhand::device_rig {

/// What `stillhand calibrate` can calibrate.
enum class CalibratedSignal : unsigned char { kForce, kAcceleration, kAngle };
inline constexpr std::array kCalibratedSignals{
    CalibratedSignal::kForce, CalibratedSignal::kAcceleration, CalibratedSignal::kAngle};

/// Its place in kCalibratedSignals, and in every table of that order.
constexpr std::size_t index_of(CalibratedSignal signal) noexcept {
  return static_cast<std::size_t>(signal);
}

/// Name of a signal as in devices.yaml, its unit, and the unit of what its sensor reads.
struct SignalWords {
  const char* name;
  const char* unit;
  const char* reading;
};
SignalWords words_of(CalibratedSignal signal) noexcept;

/// How a signal was calibrated.  Units: those of words_of().
struct CalibrationRecord {
  std::string date;  ///< YYYY-MM-DD; empty: never
  std::string person;
  std::string device;  ///< DevicePlant::device_of()
  std::string sensor;  ///< number on the sensor itself, which no interface reports
  CalibrationFit fit;
  /// Largest change of the other signals over the steps, in their present calibration.
  double cross_force_n = 0.0, cross_acceleration_m_s2 = 0.0, cross_angle_rad = 0.0;
  double input_low = 0.0, input_high = 0.0;  ///< what the input can hold; both 0: not known

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("date", self.date, Range{0.0, 10.0}, "day of the calibration, YYYY-MM-DD");
    visit("person", self.person, Range{0.0, 100.0}, "who did it");
    visit("device", self.device, Range{0.0, 300.0}, "device that was read, with its serial number");
    visit("sensor", self.sensor, Range{0.0, 100.0}, "number on the sensor itself");
    visit("zero", self.fit.zero, kAnyNumber, "[V, counts] reading at 0");
    visit("sensitivity", self.fit.sensitivity, kAnyNumber, "[V, counts a unit] of the reading");
    visit("zero_error", self.fit.zero_error, kAnyNumber, "standard error of zero");
    visit("sensitivity_error", self.fit.sensitivity_error, kAnyNumber,
          "standard error of sensitivity");
    visit("residual", self.fit.residual, kAnyNumber,
          "[N, m/s^2, rad] largest distance from the line");
    visit("noise", self.fit.noise, kAnyNumber, "[N, m/s^2, rad] largest RMS noise of a step");
    visit("drift", self.fit.drift, kAnyNumber,
          "[N, m/s^2, rad] of the first quantity, applied again");
    visit("low", self.fit.low, kAnyNumber, "[N, m/s^2, rad] lowest known quantity");
    visit("high", self.fit.high, kAnyNumber, "[N, m/s^2, rad] highest");
    visit("cross_force_n", self.cross_force_n, kAnyNumber,
          "[N] largest change of the force meanwhile");
    visit("cross_acceleration_m_s2", self.cross_acceleration_m_s2, kAnyNumber,
          "[m/s^2] the same of the acceleration");
    visit("cross_angle_rad", self.cross_angle_rad, kAnyNumber, "[rad] the same of the angle");
    visit("input_low", self.input_low, kAnyNumber,
          "[N, m/s^2] lowest quantity that the input can hold");
    visit("input_high", self.input_high, kAnyNumber, "[N, m/s^2] highest");
  }
};

/// calibration.yaml: the newest calibration of each signal.
struct Calibrations {
  CalibrationRecord force, acceleration, angle;
  PlatformRecord platform;
  HandOffRecord check;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("force", self.force);
    visit.group("acceleration", self.acceleration);
    visit.group("angle", self.angle);
    visit.group("platform", self.platform);
    visit.group("check", self.check);
  }
  [[nodiscard]] CalibrationRecord& of(CalibratedSignal signal) noexcept;
  [[nodiscard]] const CalibrationRecord& of(CalibratedSignal signal) const noexcept;
};

/// The file's calibrations; none where there is no file.
Calibrations load_calibrations(const std::filesystem::path& file);

/// A number of sensing.yaml that a calibration gives.
struct SensingNumber {
  const char* key;
  double calibrated;
  double in_use;
};
/// Those of a signal.  The angle has its zero alone: the counts of a turn are the encoder's.
std::vector<SensingNumber> sensing_numbers(CalibratedSignal signal, const CalibrationFit& fit,
                                           const sensing::Config& sensing);

/// The rule of Eq. DR-16 for one signal.
/// @param device   that measures it now
/// @param today    YYYY-MM-DD
/// @throws ConfigError with what mends it
void check_calibration(CalibratedSignal signal, const CalibrationRecord& record,
                       const std::string& device, const sensing::Config& sensing,
                       std::int64_t max_age_days, const std::string& today);

/// The drive's angle goes out in the counts of which sensing makes it again.
/// @throws ConfigError for two numbers of counts a revolution
void check_counts(const DevicesConfig& devices, const sensing::Config& sensing);

/// The rule of Eq. DR-16 for a platform's lag and bandwidth.  @param device  empty: it is simulated
void check_platform(const PlatformRecord& record, const std::string& device,
                    std::int64_t max_age_days, const std::string& today);

/// The same for the check with the hand off.  @param devices  empty: none of them is checked
void check_hand_off(const HandOffRecord& record, const std::string& devices,
                    std::int64_t max_age_days, const std::string& today);

/// Today's date, UTC.
std::string today();

}  // namespace stillhand::device_rig

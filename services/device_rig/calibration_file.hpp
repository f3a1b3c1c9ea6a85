// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "services/contract/config_field.hpp"
#include "services/device_rig/core/calibration_fit.hpp"
#include "services/sensing/core/conditioner.hpp"

namespace stillhand::device_rig {

/// What `stillhand calibrate` can calibrate.
enum class CalibratedSignal : unsigned char { kForce, kAcceleration, kAngle };
inline constexpr std::array kCalibratedSignals{
    CalibratedSignal::kForce, CalibratedSignal::kAcceleration, CalibratedSignal::kAngle};

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

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    constexpr Range kAny{-1e12, 1e12};
    visit("date", self.date, Range{0.0, 10.0}, "day of the calibration, YYYY-MM-DD");
    visit("person", self.person, Range{0.0, 100.0}, "who did it");
    visit("device", self.device, Range{0.0, 300.0}, "device that was read, with its serial number");
    visit("sensor", self.sensor, Range{0.0, 100.0}, "number on the sensor itself");
    visit("zero", self.fit.zero, kAny, "[V, counts] reading at 0");
    visit("sensitivity", self.fit.sensitivity, kAny, "[V, counts a unit] of the reading");
    visit("zero_error", self.fit.zero_error, kAny, "standard error of zero");
    visit("sensitivity_error", self.fit.sensitivity_error, kAny, "standard error of sensitivity");
    visit("residual", self.fit.residual, kAny, "[N, m/s^2, rad] largest distance from the line");
    visit("noise", self.fit.noise, kAny, "[N, m/s^2, rad] largest RMS noise of a step");
    visit("drift", self.fit.drift, kAny, "[N, m/s^2, rad] of the first quantity, applied again");
    visit("low", self.fit.low, kAny, "[N, m/s^2, rad] lowest known quantity");
    visit("high", self.fit.high, kAny, "[N, m/s^2, rad] highest");
  }
};

/// calibration.yaml: the newest calibration of each signal.
struct Calibrations {
  CalibrationRecord force, acceleration, angle;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit.group("force", self.force);
    visit.group("acceleration", self.acceleration);
    visit.group("angle", self.angle);
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

/// Today's date, UTC.
std::string today();

}  // namespace stillhand::device_rig

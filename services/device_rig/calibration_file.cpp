// SPDX-License-Identifier: Apache-2.0
#include "services/device_rig/calibration_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <optional>
#include <sstream>

#include "services/contract/config_error.hpp"
#include "services/settings/load.hpp"

namespace stillhand::device_rig {
namespace {

std::optional<std::chrono::sys_days> day_of(const std::string& date) {
  std::tm parts{};
  std::istringstream text(date);
  if (!(text >> std::get_time(&parts, "%Y-%m-%d"))) return std::nullopt;
  const std::chrono::year_month_day whole{
      std::chrono::year{parts.tm_year + 1900},
      std::chrono::month{static_cast<unsigned>(parts.tm_mon + 1)},
      std::chrono::day{static_cast<unsigned>(parts.tm_mday)}};
  if (!whole.ok()) return std::nullopt;
  return std::chrono::sys_days(whole);
}

std::string mends(CalibratedSignal signal) {
  return fmt::format(
      "`stillhand calibrate {}`; calibration.max_age_days: 0 in devices.yaml asks "
      "for none",
      words_of(signal).name);
}

}  // namespace

SignalWords words_of(CalibratedSignal signal) noexcept {
  switch (signal) {
    case CalibratedSignal::kForce:
      return {"force", "N", "V"};
    case CalibratedSignal::kAcceleration:
      return {"acceleration", "m/s^2", "V"};
    case CalibratedSignal::kAngle:
      break;
  }
  return {"angle", "rad", "counts"};
}

CalibrationRecord& Calibrations::of(CalibratedSignal signal) noexcept {
  return signal == CalibratedSignal::kForce          ? force
         : signal == CalibratedSignal::kAcceleration ? acceleration
                                                     : angle;
}

const CalibrationRecord& Calibrations::of(CalibratedSignal signal) const noexcept {
  return const_cast<Calibrations*>(this)->of(signal);
}

Calibrations load_calibrations(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return {};
  return settings::load<Calibrations>(file, "calibration");
}

std::vector<SensingNumber> sensing_numbers(CalibratedSignal signal, const CalibrationFit& fit,
                                           const sensing::Config& sensing) {
  switch (signal) {
    case CalibratedSignal::kForce:
      return {{"load_cell_sensitivity_v_n", fit.sensitivity, sensing.load_cell_sensitivity_v_n},
              {"load_cell_offset_v", fit.zero, sensing.load_cell_offset_v}};
    case CalibratedSignal::kAcceleration:
      return {{"accel_sensitivity_v_m_s2", fit.sensitivity, sensing.accel_sensitivity_v_m_s2},
              {"accel_y_offset_v", fit.zero, sensing.accel_y_offset_v}};
    case CalibratedSignal::kAngle:
      break;
  }
  return {{"encoder_zero_counts", std::round(fit.zero),
           static_cast<double>(sensing.encoder_zero_counts)}};
}

void check_calibration(CalibratedSignal signal, const CalibrationRecord& record,
                       const std::string& device, const sensing::Config& sensing,
                       std::int64_t max_age_days, const std::string& today) {
  if (device.empty() || max_age_days == 0) return;
  const std::string key = fmt::format("calibration.yaml: {}", words_of(signal).name);
  const auto made = day_of(record.date);
  const auto now = day_of(today);
  if (!made || !now) throw ConfigError(key, "no calibration of " + device, mends(signal));
  const auto age_days = (*now - *made).count();
  if (age_days > max_age_days || age_days < 0) {
    throw ConfigError(key, fmt::format("a calibration of {}, {} days ago", record.date, age_days),
                      fmt::format("one of the last {} days: {}", max_age_days, mends(signal)));
  }
  if (record.device != device) {
    throw ConfigError(key, "a calibration of \"" + record.device + "\"",
                      "one of \"" + device + "\": " + mends(signal));
  }
  for (const SensingNumber& number : sensing_numbers(signal, record.fit, sensing)) {
    // Written with every bit, but a person may have typed it again.
    constexpr double kSame = 1e-9;
    if (std::abs(number.in_use - number.calibrated) <= kSame * std::abs(number.calibrated)) {
      continue;
    }
    throw ConfigError(
        fmt::format("sensing.yaml: {}", number.key), fmt::format("{}", number.in_use),
        fmt::format("{}, as calibrated on {}: {}", number.calibrated, record.date, mends(signal)));
  }
}

std::string today() {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  return fmt::format("{:04}-{:02}-{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
}

}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#include "services/files/device_rig/calibration_file.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <ctime>
#include <iomanip>
#include <optional>
#include <sstream>

#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/files/settings/load.hpp"

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

std::string mends(const char* what) {
  const bool check = std::string(what) == "check";
  return fmt::format(
      "`stillhand calibrate {}`; calibration.{}max_age_days: 0 in devices.yaml asks for none", what,
      check ? "check_" : "");
}

/// What every record of calibration.yaml needs.
struct Made {
  const char* name;  ///< in the file, and for the verb
  std::string date;
  std::string device;  ///< with which it was made
};

void check_made(const Made& made_record, const std::string& device, std::int64_t max_age_days,
                const std::string& today) {
  const std::string key = fmt::format("calibration.yaml: {}", made_record.name);
  const auto made = day_of(made_record.date);
  const auto now = day_of(today);
  if (!made || !now) throw ConfigError(key, "no calibration of " + device, mends(made_record.name));
  const auto age_days = (*now - *made).count();
  if (age_days > max_age_days || age_days < 0) {
    throw ConfigError(
        key, fmt::format("a calibration of {}, {} days ago", made_record.date, age_days),
        fmt::format("one of the last {} days: {}", max_age_days, mends(made_record.name)));
  }
  if (made_record.device != device) {
    throw ConfigError(key, "a calibration of \"" + made_record.device + "\"",
                      "one of \"" + device + "\": " + mends(made_record.name));
  }
}

constexpr std::array<SignalWords, kCalibratedSignals.size()> kWords{
    {{"force", "N", "V"}, {"acceleration", "m/s^2", "V"}, {"angle", "rad", "counts"}}};
constexpr std::array kRecords{&Calibrations::force, &Calibrations::acceleration,
                              &Calibrations::angle};

}  // namespace

SignalWords words_of(CalibratedSignal signal) noexcept { return kWords[index_of(signal)]; }

CalibrationRecord& Calibrations::of(CalibratedSignal signal) noexcept {
  return this->*kRecords[index_of(signal)];
}

const CalibrationRecord& Calibrations::of(CalibratedSignal signal) const noexcept {
  return this->*kRecords[index_of(signal)];
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
  const char* name = words_of(signal).name;
  check_made({name, record.date, record.device}, device, max_age_days, today);
  for (const SensingNumber& number : sensing_numbers(signal, record.fit, sensing)) {
    // Written with every bit, but a person may have typed it again.
    constexpr double kSame = 1e-9;
    if (std::abs(number.in_use - number.calibrated) <= kSame * std::abs(number.calibrated)) {
      continue;
    }
    throw ConfigError(
        fmt::format("sensing.yaml: {}", number.key), fmt::format("{}", number.in_use),
        fmt::format("{}, as calibrated on {}: {}", number.calibrated, record.date, mends(name)));
  }
}

void check_counts(const DevicesConfig& devices, const sensing::Config& sensing) {
  const auto counts = static_cast<double>(devices.drive.counts_per_rev);
  if (parts_of(devices).angle != Parts::Source::kDrive) return;
  if (counts == sensing.encoder_counts_per_rev) return;
  throw ConfigError(
      "devices.drive.counts_per_rev", fmt::format("{}", counts),
      fmt::format("{}, encoder_counts_per_rev of sensing.yaml", sensing.encoder_counts_per_rev));
}

void check_platform(const PlatformRecord& record, const std::string& device,
                    std::int64_t max_age_days, const std::string& today) {
  if (device.empty() || max_age_days == 0) return;
  check_made({"platform", record.date, record.device}, device, max_age_days, today);
}

void check_hand_off(const HandOffRecord& record, const std::string& devices,
                    std::int64_t max_age_days, const std::string& today) {
  if (devices.empty() || max_age_days == 0) return;
  check_made({"check", record.date, record.devices}, devices, max_age_days, today);
}

std::string today() {
  const auto now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm parts{};
  gmtime_r(&now, &parts);
  return fmt::format("{:04}-{:02}-{:02}", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday);
}

}  // namespace stillhand::device_rig

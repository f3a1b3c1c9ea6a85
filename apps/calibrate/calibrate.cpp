// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/calibrate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <vector>

#include "apps/calibrate/ask.hpp"
#include "apps/calibrate/calibration_files.hpp"
#include "apps/calibrate/known_quantity.hpp"
#include "apps/calibrate/station.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/calibration_fit.hpp"
#include "services/devices/device_rig/load_devices.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::calibrate {
namespace {

using device_rig::CalibratedSignal;
using device_rig::CalibrationFit;
using device_rig::CalibrationStep;

// The counts of a turn are known; steps that say otherwise by more than this hold a mistake.
constexpr double kGainTolerance = 0.01;

constexpr std::array kDefaultQuantities{"0,5,10,-5,-10", "0,1g,-1g", "0,10deg,20deg,-10deg,-20deg"};

/// The steps of one calibration.
class Steps {
 public:
  Steps(const CalibrateOptions& options, Station& station) : options_(options), station_(station) {}

  /// @returns false: broken off
  bool take(const std::vector<double>& known, const runtime::Stop& interrupted) {
    for (std::size_t i = 0; i < known.size(); ++i) {
      const std::string step = fmt::format("step {} of {}: {}", i + 1, known.size(),
                                           instruction(options_.signal, known[i]));
      if (!done_by_person(step, interrupted)) return false;
      take_one(known[i]);
      if (interrupted.requested()) return false;
    }
    return true;
  }
  [[nodiscard]] const std::vector<CalibrationStep>& steps() const { return steps_; }
  /// Largest change of another signal since the first step.
  [[nodiscard]] double most_change(CalibratedSignal other, const sensing::Config& sensing) const {
    double most = 0.0;
    for (const AllReadings& each : all_) {
      const double change = in_units(other, each[index_of(other)].mean, sensing) -
                            in_units(other, all_.front()[index_of(other)].mean, sensing);
      most = std::max(most, std::abs(change));
    }
    return most;
  }

 private:
  void take_one(double known) {
    const auto words = device_rig::words_of(options_.signal);
    all_.push_back(station_.read(options_.seconds));
    const Readings& readings = all_.back()[index_of(options_.signal)];
    const char* why = station_.plant().unsound();
    if (why != nullptr || readings.missing * 100 > readings.samples) {
      throw ConfigError(fmt::format("step {}", steps_.size() + 1),
                        why != nullptr
                            ? why
                            : fmt::format("{} of {} samples without a number", readings.missing,
                                          readings.missing + readings.samples),
                        "a device that measures, inside of its range");
    }
    steps_.push_back({known, readings.mean, readings.spread, readings.samples});
    std::cout << fmt::format("  {:.4g} {}: {:.6g} {}, noise {:.2g} {} RMS, {} samples\n", known,
                             words.unit, readings.mean, words.reading, readings.spread,
                             words.reading, readings.samples);
  }

  const CalibrateOptions& options_;
  Station& station_;
  std::vector<CalibrationStep> steps_;
  std::vector<AllReadings> all_;
};

void print(const CalibrateOptions& options, const CalibrationFit& fit, const Steps& steps,
           const sensing::Config& sensing) {
  const auto words = device_rig::words_of(options.signal);
  std::cout << fmt::format(
      "{}: {:.6g} {}/{} (standard error {:.2g}), {:.6g} {} at 0 (standard error {:.2g})\n",
      words.name, fit.sensitivity, words.reading, words.unit, fit.sensitivity_error, fit.zero,
      words.reading, fit.zero_error);
  std::cout << fmt::format(
      "  from {:.4g} to {:.4g} {unit}: at most {:.2g} {unit} off the line; noise {:.2g} {unit} "
      "RMS; "
      "the first quantity again: {:+.2g} {unit}\n",
      fit.low, fit.high, fit.residual, fit.noise, fit.drift, fmt::arg("unit", words.unit));
  if (options.signal != CalibratedSignal::kAngle) {
    std::cout << fmt::format("  the input's range, {:.3g} V, is {:.4g} to {:.4g} {}\n",
                             sensing.adc_range_v,
                             (-sensing.adc_range_v - fit.zero) / fit.sensitivity,
                             (sensing.adc_range_v - fit.zero) / fit.sensitivity, words.unit);
  }
  for (const CalibratedSignal other : device_rig::kCalibratedSignals) {
    if (other == options.signal) continue;
    const auto name = device_rig::words_of(other);
    std::cout << fmt::format("  meanwhile {} changed by at most {:.2g} {}\n", name.name,
                             steps.most_change(other, sensing), name.unit);
  }
}

std::string gain_fault(const CalibrateOptions& options, const CalibrationFit& fit,
                       const sensing::Config& sensing) {
  if (options.signal != CalibratedSignal::kAngle) return {};
  const double turn_counts = 2.0 * std::numbers::pi * fit.sensitivity;
  if (std::abs(turn_counts / sensing.encoder_counts_per_rev - 1.0) <= kGainTolerance) return {};
  return fmt::format(
      "a turn has {:.0f} counts by these steps, and {:.0f} by sensing.yaml: a wrong "
      "angle, or a ratio that the drive does not know",
      turn_counts, sensing.encoder_counts_per_rev);
}

device_rig::CalibrationRecord record_of(const CalibrateOptions& options, const CalibrationFit& fit,
                                        const std::string& device, const Steps& steps,
                                        const sensing::Config& sensing) {
  device_rig::CalibrationRecord record;
  record.date = device_rig::today();
  record.person = options.person;
  record.device = device;
  record.sensor = options.sensor;
  record.fit = fit;
  const auto cross = [&](CalibratedSignal other) {
    return other == options.signal ? 0.0 : steps.most_change(other, sensing);
  };
  record.cross_force_n = cross(CalibratedSignal::kForce);
  record.cross_acceleration_m_s2 = cross(CalibratedSignal::kAcceleration);
  record.cross_angle_rad = cross(CalibratedSignal::kAngle);
  if (options.signal != CalibratedSignal::kAngle) {
    record.input_low = (-sensing.adc_range_v - fit.zero) / fit.sensitivity;
    record.input_high = (sensing.adc_range_v - fit.zero) / fit.sensitivity;
  }
  return record;
}

void write(const CalibrateOptions& options, const device_rig::CalibrationRecord& record,
           const sensing::Config& sensing) {
  const auto numbers = device_rig::sensing_numbers(options.signal, record.fit, sensing);
  for (const auto& number : numbers) {
    std::cout << fmt::format("  {}: {:.9g}, before {:.9g}\n", number.key, number.calibrated,
                             number.in_use);
  }
  device_rig::Calibrations all = device_rig::load_calibrations(options.config / "calibration.yaml");
  all.of(options.signal) = record;
  write_calibrations(options.config, all, numbers);
}

}  // namespace

int run_calibrate(const CalibrateOptions& options, const runtime::Stop& interrupted) {
  const auto words = device_rig::words_of(options.signal);
  std::vector<double> known = known_quantities(
      options.known.empty() ? kDefaultQuantities[index_of(options.signal)] : options.known,
      options.signal);
  device_rig::check_known(known);
  known.push_back(known.front());  // what slips or warms up shows
  const auto rig = settings::load<rig::RigConfig>(options.config / "rig.yaml", "rig");
  const auto file = options.config / "devices.yaml";
  const auto devices = device_rig::load_devices(file);
  const auto sensing = settings::load<sensing::Config>(options.config / "sensing.yaml", "sensing");
  Station station = settings::placed(file.string(), [&] { return Station(rig, devices); });
  const std::string device = station.plant().device_of(options.signal);
  if (device.empty()) {
    throw ConfigError(fmt::format("devices.yaml: signals.{}", words.name), "simulated",
                      "a device: a simulated sensor needs no calibration");
  }
  std::cout << fmt::format("{}: {}; no motor is armed\n", words.name, device);
  Steps steps(options, station);
  if (!steps.take(known, interrupted)) {
    runtime::remark("broken off; nothing is written");
    return 1;
  }
  const CalibrationFit fit = device_rig::calibration_fit(steps.steps());
  print(options, fit, steps, sensing);
  std::string fault = device_rig::calibration_fault(fit, options.tolerance, words.unit);
  if (fault.empty()) fault = gain_fault(options, fit, sensing);
  if (!fault.empty()) {
    runtime::remark(std::string(words.name) + ": " + fault + "; nothing is written");
    return 1;
  }
  write(options, record_of(options, fit, device, steps, sensing), sensing);
  return 0;
}

}  // namespace stillhand::calibrate

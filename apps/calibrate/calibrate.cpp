// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/calibrate.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>
#include <numbers>
#include <vector>

#include "apps/calibrate/known_quantity.hpp"
#include "apps/calibrate/station.hpp"
#include "apps/report/result_files.hpp"
#include "services/contract/config_error.hpp"
#include "services/device_rig/core/calibration_fit.hpp"
#include "services/settings/edit_text.hpp"
#include "services/settings/load.hpp"
#include "services/settings/yaml_text.hpp"

namespace stillhand::calibrate {
namespace {

using device_rig::CalibratedSignal;
using device_rig::CalibrationFit;
using device_rig::CalibrationStep;

// The counts of a turn are known; steps that say otherwise by more than this hold a mistake.
constexpr double kGainTolerance = 0.01;

const char* default_quantities(CalibratedSignal signal) {
  switch (signal) {
    case CalibratedSignal::kForce:
      return "0,5,10,-5,-10";
    case CalibratedSignal::kAcceleration:
      return "0,1g,-1g";
    case CalibratedSignal::kAngle:
      break;
  }
  return "0,10deg,20deg,-10deg,-20deg";
}

std::string text_of(const std::filesystem::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// A line on standard input; false at its end or after an interrupt.
bool enter_came(const runtime::Stop& interrupted) {
  // What was typed during a reading is no answer to this step.
  if (isatty(STDIN_FILENO) == 1) tcflush(STDIN_FILENO, TCIFLUSH);
  constexpr int kLook_ms = 50;
  while (!interrupted.requested()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, kLook_ms) <= 0) continue;
    char letter = 0;
    if (::read(STDIN_FILENO, &letter, 1) <= 0) return false;
    if (letter == '\n') return true;
  }
  return false;
}

std::size_t index_of(CalibratedSignal signal) { return static_cast<std::size_t>(signal); }

/// What a sensor gave, in the unit of its signal, by the calibration that is in use.
double in_units(CalibratedSignal signal, double reading, const sensing::Config& sensing) {
  switch (signal) {
    case CalibratedSignal::kForce:
      return (reading - sensing.load_cell_offset_v) / sensing.load_cell_sensitivity_v_n;
    case CalibratedSignal::kAcceleration:
      return (reading - sensing.accel_y_offset_v) / sensing.accel_sensitivity_v_m_s2;
    case CalibratedSignal::kAngle:
      break;
  }
  return 2.0 * std::numbers::pi * (reading - static_cast<double>(sensing.encoder_zero_counts)) /
         sensing.encoder_counts_per_rev;
}

/// The steps of one calibration.
class Steps {
 public:
  Steps(const CalibrateOptions& options, Station& station) : options_(options), station_(station) {}

  /// @returns false: broken off
  bool take(const std::vector<double>& known, const runtime::Stop& interrupted) {
    for (std::size_t i = 0; i < known.size(); ++i) {
      std::cout << fmt::format("step {} of {}: {} Then press Enter.\n", i + 1, known.size(),
                               instruction(options_.signal, known[i]))
                << std::flush;
      if (!enter_came(interrupted)) return false;
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
      "  from {:.4g} to {:.4g} {}: at most {:.2g} off the line; noise {:.2g} RMS; the first "
      "quantity again: {:+.2g}\n",
      fit.low, fit.high, words.unit, fit.residual, fit.noise, fit.drift);
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

void write(const CalibrateOptions& options, const CalibrationFit& fit, const std::string& device,
           const sensing::Config& sensing) {
  const auto sensing_file = options.config / "sensing.yaml";
  const auto file = options.config / "calibration.yaml";
  std::string text = text_of(sensing_file);
  for (const auto& number : device_rig::sensing_numbers(options.signal, fit, sensing)) {
    std::cout << fmt::format("  {}: {:.9g}, before {:.9g}\n", number.key, number.calibrated,
                             number.in_use);
    text =
        settings::with_setting(std::move(text), number.key, fmt::format("{}", number.calibrated));
  }
  // Its numbers must be ones that sensing accepts.
  settings::load_text<sensing::Config>(text, "sensing", "calibration");
  device_rig::Calibrations all = device_rig::load_calibrations(file);
  all.of(options.signal) = {device_rig::today(), options.person, device, options.sensor, fit};
  const std::string calibrations =
      "# Written by `stillhand calibrate`; services/device_rig/README.md, Eq. DR-16.\n" +
      settings::yaml_text(all);
  settings::load_text<device_rig::Calibrations>(calibrations, "calibration", "calibration");
  report::ResultFiles files({{"sensing.yaml", sensing_file}, {"calibration.yaml", file}}, {});
  files.set("sensing.yaml", text);
  files.set("calibration.yaml", calibrations);
  files.publish();
  std::cout << "wrote " << sensing_file.string() << " and " << file.string() << '\n';
}

}  // namespace

int run_calibrate(const CalibrateOptions& options, const runtime::Stop& interrupted) {
  const auto words = device_rig::words_of(options.signal);
  std::vector<double> known = known_quantities(
      options.known.empty() ? default_quantities(options.signal) : options.known, options.signal);
  device_rig::check_known(known);
  known.push_back(known.front());  // what slips or warms up shows
  const auto rig = settings::load<rig::RigConfig>(options.config / "rig.yaml", "rig");
  const auto devices =
      settings::load<device_rig::DevicesConfig>(options.config / "devices.yaml", "devices");
  const auto sensing = settings::load<sensing::Config>(options.config / "sensing.yaml", "sensing");
  Station station(rig, devices);
  const std::string device = station.plant().device_of(options.signal);
  if (device.empty()) {
    throw ConfigError(fmt::format("devices.yaml: signals.{}", words.name), "simulated",
                      "a device: a simulated sensor needs no calibration");
  }
  std::cout << fmt::format("{}: {}; no motor is armed\n", words.name, device);
  Steps steps(options, station);
  if (!steps.take(known, interrupted)) {
    std::cerr << "stillhand calibrate: broken off; nothing is written\n";
    return 1;
  }
  const CalibrationFit fit = device_rig::calibration_fit(steps.steps());
  print(options, fit, steps, sensing);
  std::string fault = device_rig::calibration_fault(fit, options.tolerance);
  if (fault.empty()) fault = gain_fault(options, fit, sensing);
  if (!fault.empty()) {
    std::cerr << "stillhand calibrate: " << words.name << ": " << fault << "; nothing is written\n";
    return 1;
  }
  write(options, fit, device, sensing);
  return 0;
}

}  // namespace stillhand::calibrate

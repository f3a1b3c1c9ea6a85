// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/platform_steps.hpp"

#include <fmt/format.h>

#include <cmath>
#include <iostream>
#include <limits>
#include <numbers>
#include <optional>

#include "apps/calibrate/ask.hpp"
#include "apps/calibrate/calibration_files.hpp"
#include "apps/calibrate/station.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/platform_response.hpp"
#include "services/devices/device_rig/load_devices.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::calibrate {
namespace {

using device_rig::CalibratedSignal;
using device_rig::PlatformResponse;

constexpr Tick kSettle_ticks = 300;
constexpr Tick kBrake_ticks = 500;
constexpr double kScale = 0.2;            // of gains that have to be 1: our own choice
constexpr double kPeggedMotion_hz = 4.0;  // highest of the pegged trial (apps/libraries/session)
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Where the platform stands, while nothing moves it.
/// @param where  its address in devices.yaml, for the error
double place_of(Station& station, const std::string& where) {
  station.restart_clock();
  const double place_m = station.rest(kSettle_ticks).truth.platform_position_m;
  if (const char* why = station.plant().unsound(); why != nullptr) {
    throw ConfigError(where, why, "a platform that answers");
  }
  return place_m;
}

/// @returns nothing: broken off
std::optional<PlatformResponse> moved(const CalibrateOptions& options, Station& station,
                                      double place_m, const sensing::Config& sensing,
                                      const std::string& where, const runtime::Stop& interrupted) {
  const bool seat = !station.plant().device_of(CalibratedSignal::kAcceleration).empty();
  device_rig::PlatformTest test({.motion_m = options.motion_m}, options.periods);
  station.restart_clock();
  const Trial trial = station.engage(place_m);
  for (Tick tick = 0; tick < test.ticks(); ++tick) {
    const auto set_point = test.at(tick);
    rig::RigInput input;
    input.command_valid = true;
    input.command_position_m = place_m + set_point.pos_m;
    input.command_velocity_m_s = set_point.vel_m_s;
    input.command_acceleration_m_s2 = set_point.accel_m_s2;
    const rig::RigOutput output = station.tick(input, trial);
    test.take(
        tick, output.truth.platform_position_m - place_m,
        seat ? in_units(CalibratedSignal::kAcceleration, output.raw.accel_y_v, sensing) : kUnknown);
    if (interrupted.requested()) {
      station.rest(kBrake_ticks);
      return std::nullopt;
    }
    if (const char* why = station.plant().unsound(); why != nullptr) {
      station.rest(kBrake_ticks);
      throw ConfigError(where, why, "devices that work during the motion");
    }
  }
  const double lost_s = station.lost_s();
  station.rest(kBrake_ticks);
  // A motion that stood still is another motion.
  if (constexpr double kMost_s = 0.05; lost_s > kMost_s) {
    throw ConfigError("this machine", fmt::format("it stood still for {:.2f} s", lost_s),
                      fmt::format("at most {} s during the motion: less other work", kMost_s));
  }
  return test.result();
}

void print(const PlatformResponse& found) {
  std::cout << "   Hz    gain   phase [deg]   standard error\n";
  for (const auto& line : found.lines) {
    std::cout << fmt::format("{:5.1f}  {:6.3f}  {:10.1f}  {:10.4f}\n", line.frequency_hz,
                             std::abs(line.response),
                             std::arg(line.response) * 180.0 / std::numbers::pi, line.error);
  }
  std::cout << fmt::format("lag {:.1f} ms (standard error {:.1f}), 0.5 to 4 Hz\n",
                           1e3 * found.lag_s, 1e3 * found.lag_error_s);
  std::cout << (found.bandwidth_seen
                    ? fmt::format("bandwidth {:.2f} Hz (standard error {:.2f})\n",
                                  found.bandwidth_hz, found.bandwidth_error_hz)
                    : fmt::format("bandwidth beyond {:.0f} Hz\n", found.bandwidth_hz));
  std::cout << fmt::format("gain at 0.5 Hz {:.4f} (standard error {:.4f})\n", found.gain,
                           found.gain_error);
  if (found.seat_seen) {
    std::cout << fmt::format(
        "the accelerometer reads {:.3f} (standard error {:.3f}) of the platform's own "
        "acceleration\n",
        found.seat_gain, found.seat_gain_error);
  }
  if (found.bandwidth_seen && found.bandwidth_hz < kPeggedMotion_hz) {
    std::cout << fmt::format(
        "the pegged trial moves at up to {:.0f} Hz: beyond {:.1f} Hz it excites little\n",
        kPeggedMotion_hz, found.bandwidth_hz);
  }
}

std::string fault_of(const PlatformResponse& found) {
  if (std::abs(found.gain - 1.0) > kScale) {
    return fmt::format("the state moves by {:.2f} of the set-point: its scale", found.gain);
  }
  if (!found.seat_seen) return {};
  if (found.seat_gain < 0.0) {
    return "the accelerometer moves against the platform: turn it, or change its sign";
  }
  if (std::abs(found.seat_gain - 1.0) > kScale) {
    return fmt::format(
        "the accelerometer reads {:.2f} of the platform's own acceleration: calibrate it first",
        found.seat_gain);
  }
  return {};
}

}  // namespace

int run_calibrate_platform(const CalibrateOptions& options, const runtime::Stop& interrupted) {
  const auto rig = settings::load<rig::RigConfig>(options.config / "rig.yaml", "rig");
  const auto file = options.config / "devices.yaml";
  const auto devices = device_rig::load_devices(file);
  const auto sensing = settings::load<sensing::Config>(options.config / "sensing.yaml", "sensing");
  Station station = settings::placed(file.string(), [&] { return Station(rig, devices); });
  const std::string device = station.plant().platform_device();
  if (device.empty()) {
    throw ConfigError("devices.yaml: signals.platform", "simulated",
                      "a device: a simulated platform needs no identification");
  }
  const std::string where = fmt::format("{} (platform at {}:{})", file.string(),
                                        devices.platform.address, devices.platform.port);
  const double place_m = place_of(station, where);
  if (!(std::abs(place_m) + options.motion_m <= rig.platform.workspace_m)) {
    throw ConfigError("platform", fmt::format("it stands at {:+.3f} m", place_m),
                      fmt::format("{:.3f} m of way to both sides, within +-{:.3f} m",
                                  options.motion_m, rig.platform.workspace_m));
  }
  std::cout << fmt::format("platform: {}, at {:+.4f} m; no motor is armed\n", device, place_m);
  const std::string step = fmt::format(
      "step 1 of 1: Take everybody off the platform; it moves by up to {:.1f} mm to both sides for "
      "{} s, and brakes on Ctrl-C.",
      1e3 * options.motion_m, 2 * options.periods + 6);
  const auto broken_off = [] {
    runtime::remark("broken off; nothing is written");
    return 1;
  };
  if (!done_by_person(step, interrupted)) return broken_off();
  const auto found = moved(options, station, place_of(station, where), sensing, where, interrupted);
  if (!found) return broken_off();
  print(*found);
  if (const std::string fault = fault_of(*found); !fault.empty()) {
    runtime::remark("platform: " + fault + "; nothing is written");
    return 1;
  }
  auto all = device_rig::load_calibrations(options.config / "calibration.yaml");
  all.platform = {.date = device_rig::today(),
                  .person = options.person,
                  .device = device,
                  .lag_s = found->lag_s,
                  .lag_error_s = found->lag_error_s,
                  .bandwidth_hz = found->bandwidth_hz,
                  .bandwidth_error_hz = found->bandwidth_error_hz,
                  .bandwidth_seen = found->bandwidth_seen,
                  .gain = found->gain,
                  .gain_error = found->gain_error,
                  .seat_gain = found->seat_gain,
                  .seat_gain_error = found->seat_gain_error,
                  .motion_m = options.motion_m};
  write_calibrations(options.config, all);
  return 0;
}

}  // namespace stillhand::calibrate

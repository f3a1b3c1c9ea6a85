// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/hand_off_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include "apps/calibrate/ask.hpp"
#include "apps/calibrate/calibration_files.hpp"
#include "apps/calibrate/known_quantity.hpp"
#include "apps/calibrate/station.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/device_rig/hand_off.hpp"
#include "services/core/signal/smooth_step.hpp"
#include "services/devices/device_rig/load_devices.hpp"
#include "services/files/settings/load.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::calibrate {
namespace {

using device_rig::CalibratedSignal;

constexpr double kStep_s = 0.5;        // of each reading
constexpr double kMoved_m = 0.001;     // a push that moved the hand's place so far is seen
constexpr double kRise_n_s = 4.0;      // of a push
constexpr Tick kArm_ticks = 100;       // at zero force, before the push
constexpr Tick kLongest_ticks = 1500;  // of a push
constexpr Tick kEnd_ticks = 300;       // ramp to zero, and the driver off
constexpr Tick kStroke_ticks = 200;
constexpr Tick kHold_ticks = 300;
constexpr int kStrokes = 3;
constexpr std::size_t kMostLag_ticks = 250;

/// Something is wrong; the words are for the person at the rig.
struct Wrong {
  std::string what;
};
struct BrokenOff {};

class HandOff {
 public:
  HandOff(const CalibrateOptions& options, const rig::RigConfig& rig,
          const device_rig::DevicesConfig& devices, const sensing::Config& sensing,
          const runtime::Stop& interrupted)
      : options_(options),
        rig_(rig),
        sensing_(sensing),
        interrupted_(interrupted),
        station_(rig, devices),
        drives_(!station_.plant().pushing_devices().empty()) {}

  device_rig::HandOffRecord run() {
    const auto& plant = station_.plant();
    const bool stick = is_device(CalibratedSignal::kAngle);
    const bool cell = is_device(CalibratedSignal::kForce);
    const bool platform = !plant.platform_device().empty();
    if (!stick && !cell && !drives_ && !platform) {
      throw ConfigError("devices.yaml: signals", "everything simulated",
                        "a device: a simulated part needs no check");
    }
    of_ = (stick ? 2 : 0) + (cell ? 2 : 0) + (drives_ ? 1 : 0) + (platform ? 1 : 0);
    if (stick) travel();
    if (cell) weight();
    if (drives_) pushes();
    if (platform) strokes();
    record_.date = device_rig::today();
    record_.person = options_.person;
    record_.devices = plant.pushing_devices();
    return record_;
  }

 private:
  [[nodiscard]] bool is_device(CalibratedSignal signal) const {
    return !station_.plant().device_of(signal).empty();
  }
  void ask(const std::string& what) {
    const std::string step = fmt::format("step {} of {}: {}", ++step_, of_, what);
    if (!done_by_person(step, interrupted_)) throw BrokenOff{};
  }
  void check_devices() const {
    if (const char* why = station_.plant().unsound(); why != nullptr) throw Wrong{why};
    if (interrupted_.requested()) throw BrokenOff{};
  }
  static void refuse(const std::string& fault) {
    if (!fault.empty()) throw Wrong{fault};
  }
  double read(CalibratedSignal signal) {
    const AllReadings all = station_.read(kStep_s);
    check_devices();
    const Readings& readings = all[index_of(signal)];
    if (readings.missing * 100 > readings.samples) throw Wrong{"a sensor without numbers"};
    return in_units(signal, readings.mean, sensing_);
  }
  double place_m(const rig::RigOutput& output) const {
    return rig_.stick.lever_m * in_units(CalibratedSignal::kAngle, counts_of(output.raw), sensing_);
  }

  void travel() {
    ask("Hold the stick at its right stop.");
    record_.right_stop_rad = read(CalibratedSignal::kAngle);
    ask("Hold the stick at its left stop.");
    record_.left_stop_rad = read(CalibratedSignal::kAngle);
    std::cout << fmt::format("  the stops are at {:+.3f} and {:+.3f} rad\n", record_.right_stop_rad,
                             record_.left_stop_rad);
    refuse(device_rig::travel_fault(record_.right_stop_rad, record_.left_stop_rad,
                                    rig_.stick.stop_angle_rad));
  }

  void weight() {
    ask("Take every hand and weight off the stick.");
    const double rest_n = read(CalibratedSignal::kForce);
    ask(fmt::format("Pull the grip to the right with {:.3g} N ({:.4g} kg on a cord over a pulley).",
                    options_.push_n, options_.push_n / kGravity_m_s2));
    const double pull_n = read(CalibratedSignal::kForce) - rest_n;
    std::cout << fmt::format("  {:+.3f} N\n", pull_n);
    record_.force_gain = pull_n / options_.push_n;
    refuse(device_rig::weight_fault(pull_n, options_.push_n));
  }

  void pushes() {
    ask(
        fmt::format("Take every hand and weight off the stick and keep away from it: the motor "
                    "pushes it to the "
                    "right and to the left, with at most {:.3g} N, until it moved by 1 mm.",
                    options_.push_n));
    const device_rig::Push right = push(options_.push_n);
    const device_rig::Push left = push(-options_.push_n);
    record_.pushed_right_m = right.moved_m;
    record_.pushed_left_m = left.moved_m;
    const double asked_n = right.asked_n - left.asked_n;
    record_.torque_gain = asked_n > 0.0 ? (right.measured_n - left.measured_n) / asked_n : 0.0;
    for (const auto& each : {right, left}) refuse(device_rig::push_fault(each, kMoved_m));
  }

  // A trial of its own: the drive is armed at zero force, where the stick stands, and off again.
  device_rig::Push push(double most_n) {
    station_.restart_clock();
    const double from_m = place_m(station_.rest(kArm_ticks));
    check_devices();
    if (!std::isfinite(from_m)) throw Wrong{"the angle is not known"};
    const Trial trial{.number = ++trial_,
                      .phase = TrialPhase::kTracking,
                      .start_tick = station_.next_tick(),
                      .duration_ticks = kLongest_ticks};
    device_rig::Push seen;
    for (Tick tick = 0; tick < kLongest_ticks; ++tick) {
      const double rise_n = kRise_n_s * kControlPeriod_s * static_cast<double>(tick - kArm_ticks);
      rig::RigInput input{.leave = MotionLeave::kHold};
      input.motor_valid = input.motor_permitted = true;
      input.motor_force_n = std::copysign(std::clamp(rise_n, 0.0, std::abs(most_n)), most_n);
      const rig::RigOutput output = station_.tick(input, trial);
      if (interrupted_.requested() || station_.plant().unsound() != nullptr) break;
      if (output.truth.motor_force_n == 0.0) continue;
      seen.asked_n = output.truth.motor_force_n;
      seen.measured_n = station_.plant().measured_force_n();
      seen.moved_m = place_m(output) - from_m;
      // An unknown place ends the push too.
      if (!(std::abs(seen.moved_m) < kMoved_m)) break;
    }
    for (Tick tick = 0; tick < kEnd_ticks; ++tick) {
      station_.tick({.leave = MotionLeave::kHold}, trial);
    }
    check_devices();
    std::cout << fmt::format(
        "  asked for {:+.2f} N at most, measured by the drive {:+.2f} N; the stick moved by "
        "{:+.2f} "
        "mm\n",
        seen.asked_n, seen.measured_n, 1e3 * seen.moved_m);
    if (seen.asked_n == 0.0) throw Wrong{"the drive was not armed"};
    return seen;
  }

  void strokes() {
    ask(
        fmt::format("Take everybody off the platform: it moves by {:.3g} mm to the right and back, "
                    "{} times. Its "
                    "way of {:.3g} m to both sides is free, and somebody is at the emergency stop.",
                    1e3 * options_.step_m, kStrokes, rig_.platform.workspace_m));
    station_.restart_clock();
    at_m_ = station_.rest(kHold_ticks).truth.platform_position_m;
    check_devices();
    if (!(std::abs(at_m_) + options_.step_m <= rig_.platform.workspace_m)) {
      throw Wrong{fmt::format("the platform stands at {:+.3f} m, at its end", at_m_)};
    }
    seat_trial_ = station_.engage(at_m_);
    device_rig::Stroke stroke{.asked_m = options_.step_m};
    for (int i = 0; i < kStrokes; ++i) {
      const double before_m = reached(0.0);
      stroke.moved_m += (reached(options_.step_m) - before_m) / kStrokes;
    }
    reached(0.0);
    station_.rest(kHold_ticks);
    stroke.seat_seen = is_device(CalibratedSignal::kAcceleration);
    if (stroke.seat_seen) {
      stroke.seat_gain = device_rig::stroke_gain(asked_m_s2_, read_m_s2_, kMostLag_ticks);
    }
    record_.platform_gain = stroke.moved_m / options_.step_m;
    record_.seat_gain = stroke.seat_gain;
    std::cout << fmt::format("  the platform moved by {:+.3f} mm", 1e3 * stroke.moved_m);
    if (stroke.seat_seen)
      std::cout << fmt::format("; the accelerometer reads {:+.2f} of it", stroke.seat_gain);
    std::cout << '\n';
    refuse(device_rig::stroke_fault(stroke));
  }

  // Goes there at rest from the last place, by Eq. SG-18, and holds.
  // @returns where the platform is then
  double reached(double offset_m) {
    const double from_m = offset_m_;
    offset_m_ = offset_m;
    constexpr double kLength_s = kControlPeriod_s * static_cast<double>(kStroke_ticks);
    rig::RigOutput output{};
    for (Tick tick = 1; tick <= kStroke_ticks + kHold_ticks; ++tick) {
      const double u =
          std::min(1.0, static_cast<double>(tick) / static_cast<double>(kStroke_ticks));
      const double way_m = offset_m - from_m;
      rig::RigInput input;
      input.command_valid = true;
      input.command_position_m = at_m_ + from_m + way_m * signal::smooth_step(u);
      input.command_velocity_m_s = way_m * signal::smooth_step_speed(u) / kLength_s;
      input.command_acceleration_m_s2 =
          way_m * signal::smooth_step_bend(u) / (kLength_s * kLength_s);
      output = station_.tick(input, seat_trial_);
      check_devices();
      const double seat_m_s2 =
          in_units(CalibratedSignal::kAcceleration, output.raw.accel_y_v, sensing_);
      asked_m_s2_.push_back(input.command_acceleration_m_s2);
      read_m_s2_.push_back(std::isfinite(seat_m_s2) || read_m_s2_.empty() ? seat_m_s2
                                                                          : read_m_s2_.back());
    }
    return output.truth.platform_position_m;
  }

  const CalibrateOptions& options_;
  const rig::RigConfig& rig_;
  const sensing::Config& sensing_;
  const runtime::Stop& interrupted_;
  Station station_;
  bool drives_;
  int step_ = 0, of_ = 0;
  std::int64_t trial_ = 0;
  Trial seat_trial_;  ///< of the strokes
  double at_m_ = 0.0, offset_m_ = 0.0;
  std::vector<double> asked_m_s2_, read_m_s2_;
  device_rig::HandOffRecord record_;
};

}  // namespace

int run_hand_off_check(const CalibrateOptions& options, const runtime::Stop& interrupted) {
  const auto rig = settings::load<rig::RigConfig>(options.config / "rig.yaml", "rig");
  const auto file = options.config / "devices.yaml";
  const auto devices = device_rig::load_devices(file);
  const auto sensing = settings::load<sensing::Config>(options.config / "sensing.yaml", "sensing");
  HandOff check = settings::placed(
      file.string(), [&] { return HandOff(options, rig, devices, sensing, interrupted); });
  const auto forget_earlier_check = [&] {
    auto all = device_rig::load_calibrations(options.config / "calibration.yaml");
    if (all.check.date.empty()) return;
    all.check = {};
    write_calibrations(options.config, all);
  };
  try {
    auto all = device_rig::load_calibrations(options.config / "calibration.yaml");
    all.check = check.run();
    write_calibrations(options.config, all);
    return 0;
  } catch (const Wrong& wrong) {
    runtime::remark("check: " + wrong.what + "; no session pushes before it is right");
    forget_earlier_check();
  } catch (const ConfigError&) {
    // A figure that is no number: nothing is known.
    forget_earlier_check();
    throw;
  } catch (const BrokenOff&) {
    runtime::remark("broken off; nothing is written");
  }
  return 1;
}

}  // namespace stillhand::calibrate

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "services/core/sensing/conditioner.hpp"
#include "services/devices/device_rig/device_plant.hpp"

namespace stillhand::calibrate {

/// Mean and spread of what one sensor gave.
struct Readings {
  double mean = 0.0;    ///< [V] or [counts]
  double spread = 0.0;  ///< standard deviation of the samples, the same unit
  std::int64_t samples = 0;
  std::int64_t missing = 0;  ///< no number, or no young one
};
/// Encoder counts of a sample; NaN: the angle is not known.
double counts_of(const rig::RawSample& raw) noexcept;

/// What a sensor gave, in the unit of its signal, by the calibration that is in use.
double in_units(device_rig::CalibratedSignal signal, double reading,
                const sensing::Config& sensing) noexcept;

using AllReadings = std::array<Readings, device_rig::kCalibratedSignals.size()>;

/// The devices of a rig without a session.  They are read; without an input no motor is armed (no
/// trial permits it), and a platform holds.
class Station {
 public:
  /// @throws ConfigError as DevicePlant
  Station(const rig::RigConfig& rig, const device_rig::DevicesConfig& devices)
      : plant_(in_real_time(rig), devices) {}

  /// One millisecond later: devices are read, and get what the input asks for.
  rig::RigOutput tick(const rig::RigInput& input = {.leave = MotionLeave::kHold},
                      const Trial& trial = {});
  /// Engages the platform where it stands, as before a trial of a session: a person agreed to its
  /// motion.  Whether it worked, plant().unsound() says from the next tick on.
  /// @returns a trial that begins with the next tick; its stick is pegged, so that no motor is
  /// armed
  Trial engage(double place_m);
  /// The next tick() is a millisecond from now.
  void restart_clock();
  /// So many ticks without an input.
  /// @returns the last
  rig::RigOutput rest(Tick ticks);
  [[nodiscard]] Tick next_tick() const noexcept { return tick_; }
  /// How long this machine stood still since restart_clock(), beyond what was caught up [s].
  [[nodiscard]] double lost_s() const noexcept { return 1e-9 * static_cast<double>(lost_ns_); }

  /// Reads every signal once a millisecond.  The first moments, in which the devices answer again,
  /// do not count.
  AllReadings read(double seconds);
  [[nodiscard]] const device_rig::DevicePlant& plant() const noexcept { return plant_; }

 private:
  /// Asks for the priority of a session's rig, for this thread and those of the devices.
  static const rig::RigConfig& in_real_time(const rig::RigConfig& rig);

  device_rig::DevicePlant plant_;
  Tick tick_ = 0;
  std::int64_t engaged_ = 0;
  std::int64_t lost_ns_ = 0;
  std::int64_t due_ns_ = 0;
};

}  // namespace stillhand::calibrate

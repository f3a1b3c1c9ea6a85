// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "services/device_rig/device_plant.hpp"
#include "services/sensing/core/conditioner.hpp"

namespace stillhand::calibrate {

/// Mean and spread of what one sensor gave.
struct Readings {
  double mean = 0.0;    ///< [V] or [counts]
  double spread = 0.0;  ///< standard deviation of the samples, the same unit
  std::int64_t samples = 0;
  std::int64_t missing = 0;  ///< no number, or no young one
};
using AllReadings = std::array<Readings, device_rig::kCalibratedSignals.size()>;

/// The devices of a rig without a session: they are read, no motor is armed (no trial permits it),
/// and a platform brakes and holds.
class Station {
 public:
  /// @throws ConfigError as DevicePlant
  Station(const rig::RigConfig& rig, const device_rig::DevicesConfig& devices)
      : plant_(rig, devices) {}

  /// Reads every signal once a millisecond.  The first moments, in which the devices answer again,
  /// do not count.
  AllReadings read(double seconds);
  [[nodiscard]] const device_rig::DevicePlant& plant() const noexcept { return plant_; }

 private:
  rig::RawSample tick();

  device_rig::DevicePlant plant_;
  Tick tick_ = 0;
  std::int64_t due_ns_ = 0;
};

}  // namespace stillhand::calibrate

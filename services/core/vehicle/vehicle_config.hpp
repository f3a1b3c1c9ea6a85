// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/contract/config_field.hpp"

namespace stillhand::vehicle {

/// Ticks between a sensed sample and the tick of the platform command that answers it; those of the
/// motion process (services/processes/motion/shell.hpp), so that the rig has every command in time.
inline constexpr std::int64_t kLead_ticks = 20;

/// High-pass that keeps the motion within the platform's travel, Eq. VH-4.
struct Washout {
  double natural_hz = 0.4;
  double damping_ratio = 0.7;
  double centring_hz = 0.05;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("natural_hz", self.natural_hz, Range{0.05, 2.0},
          "[Hz] acceleration below it is taken away; own choice: below the body's resonances");
    visit("damping_ratio", self.damping_ratio, Range{0.3, 1.5}, "[-] of the same; own choice");
    visit("centring_hz", self.centring_hz, Range{0.0, 1.0},
          "[Hz] third pole, which brings the platform back to the middle; own choice");
  }
};

/// A vehicle whose acceleration follows the stick.
struct VehicleConfig {
  bool speed_follows = false;
  std::int64_t order = 1;
  double gain_m_s2_rad = 3.0;
  double delay_s = 0.1;
  double lag_s = 0.2;
  double natural_hz = 2.0;
  double damping_ratio = 0.6;
  double max_stick_rad = 0.5235987755982988;
  double max_acceleration_m_s2 = 5.0;
  std::int64_t max_hold_ticks = 50;
  Washout washout;

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("speed_follows", self.speed_follows, Range{0.0, 1.0},
          "[-] true: the stick sets a speed; false: an acceleration");
    visit("order", self.order, Range{1.0, 2.0}, "[-] of the vehicle's dynamics, Eq. VH-2, VH-3");
    visit("gain_m_s2_rad", self.gain_m_s2_rad, Range{0.0, 100.0},
          "[m/s^2 per rad] acceleration per stick angle, at 0 Hz; of a speed, the largest over "
          "frequency");
    visit("delay_s", self.delay_s, Range{0.02, 1.0},
          "[s] from the stick's sample to the command, the 20 ticks of lead included");
    visit("lag_s", self.lag_s, Range{0.005, 10.0}, "[s] T of a vehicle of first order");
    visit("natural_hz", self.natural_hz, Range{0.1, 20.0}, "[Hz] of a vehicle of second order");
    visit("damping_ratio", self.damping_ratio, Range{0.05, 0.99}, "[-] of the same");
    visit("max_stick_rad", self.max_stick_rad, Range{0.05, 0.6},
          "[rad] stick angle at which the command saturates; paper III-C, 30 degrees");
    visit("max_acceleration_m_s2", self.max_acceleration_m_s2, Range{0.1, 9.0},
          "[m/s^2] bound of the commanded acceleration; own choice, below the paper's 7.5 peak");
    visit("max_hold_ticks", self.max_hold_ticks, Range{1.0, 200.0},
          "[ticks] longest run of missing or unsound stick samples bridged by the last; then 0");
    visit.group("washout", self.washout);
  }
};

/// "first_order", "second_order", "excavator", "wheelchair", "aircraft_roll".
const std::vector<std::string>& preset_names();
/// Settings of a preset; README, "Presets" has the sources.
/// @throws stillhand::ConfigError for another name.
VehicleConfig preset(std::string_view name);

}  // namespace stillhand::vehicle

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>

#include "services/core/contract/flag.hpp"
#include "services/core/signal/delay_line.hpp"
#include "services/core/signal/second_order_lag.hpp"
#include "services/core/vehicle/vehicle_config.hpp"

namespace stillhand::vehicle {

/// One tick of the stick, and where the platform is.
struct VehicleInput {
  double theta_rad = 0.0;            ///< stick, + right
  bool sound = false;                ///< the sample is there and good
  double share = 0.0;                ///< [-] 0 to 1: fades the command in and out
  double platform_position_m = 0.0;  ///< as last commanded, behind the guard
  double platform_velocity_m_s = 0.0;
};

/// Where the platform is asked to be; of constant acceleration over the tick.
struct VehicleMotion {
  double position_m = 0.0;
  double velocity_m_s = 0.0;
  double acceleration_m_s2 = 0.0;
  Flags flags = kGood;  ///< kInputStale: a stick sample was bridged; kSaturated: |a| at its bound
};

/// A vehicle under the stick, on a platform of limited travel, METHOD Eq. VH-1 to VH-5:
///
///   u = G clip(theta, th_max) share, late by the delay            (VH-1)
///   a_v = u lagged, of first or second order; or the speed is     (VH-2, VH-3)
///   a = clip(a_v - d2 v - d1 x - d0 z),  z' = x                   (VH-4, washout)
///   x1 = x + v dt + a dt^2/2,  v1 = v + a dt                      (VH-5)
///
/// x and v are the platform's own, behind its guard (services/processes/motion, Eq. MO-1 to MO-5):
/// where the guard had to shape a command, the washout goes on from the place where the platform
/// is. |a| <= max_acceleration_m_s2 for every input.  A stick sample that is missing or not finite
/// is bridged by the last one, and after max_hold_ticks by the centre. Frame: lateral, + right.
/// Pure; step() never allocates or throws; one thread.
class Vehicle {
 public:
  /// @throws stillhand::ConfigError naming the first field that is out of range.
  explicit Vehicle(const VehicleConfig& config);

  VehicleMotion step(const VehicleInput& input) noexcept;
  /// Forgets all motion and the delay's content.
  void reset() noexcept;

 private:
  double stick(const VehicleInput& input, Flags& flags) noexcept;
  double vehicle_acceleration(double command_m_s2) noexcept;

  VehicleConfig config_;
  signal::DelayLine delay_;
  signal::SecondOrderLag second_;
  double keep_;                ///< exp(-dt/T)
  double d0_, d1_, d2_;        ///< of Eq. VH-4
  double first_m_s2_ = 0.0;    ///< y of Eq. VH-2
  double centring_m_s_ = 0.0;  ///< z
  double held_rad_ = 0.0;
  std::int64_t absent_ = 0;
};

/// Acceleration of the platform per stick angle [m/s^2 per rad], Eqs. VH-1 to VH-5 at 1 kHz without
/// bounds.  The delay is the whole one: from the stick's sample to the tick of the command.
/// Pure.  @param frequency_hz  positive, below 500 Hz
std::complex<double> vehicle_response(const VehicleConfig& config, double frequency_hz) noexcept;

}  // namespace stillhand::vehicle

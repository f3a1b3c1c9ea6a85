// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "services/core/rig/parts/chain.hpp"
#include "services/core/signal/delay_line.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::rig {

/// Derivative of a fractional order a between 0 and 1 by lags whose rates are a factor 3 apart from
/// 0.002 to 354 Hz, METHOD Eq. RG-35:
///
///   D^a x ~ sum g_i (x - x_i),   dx_i/dt = w_i (x - x_i),   g_i = w_i^a ln(3) sin(a pi)/pi
///
/// Pure; step() never allocates or throws.
class FractionalLadder {
 public:
  FractionalLadder(double exponent, double period_s);

  /// Advances one tick.  @param x  at the end of the tick
  void step(double x) noexcept;
  /// D^a x with the lags as they are.
  [[nodiscard]] double derivative(double x) const noexcept;

 private:
  static constexpr std::size_t kLags = 12;
  std::array<double, kLags> gain_{};
  std::array<double, kLags> blend_{};
  std::array<double, kLags> lag_{};
};

/// Positions and velocities of the chain, relative to the platform.
struct ChainPlace {
  double trunk_m, trunk_m_s;
  double arm_m, arm_m_s;
  double stick_m, stick_m_s;
};

/// Forces in addition to those of Eq. RG-3 and RG-4, + right.
struct ChainForces {
  double trunk_n = 0.0;
  double arm_n = 0.0;
  double hand_n = 0.0;   ///< on the hand, above the load cell
  double stick_n = 0.0;  ///< on the stick, below it
};

/// Parameters of an effect that the chain of Eq. RG-3 lacks, as a difference force.  d = x_a - x_t
/// is the stretch of the shoulder, s = x_a - x_j that of the grip.  `spring` determines which
/// numbers are used.
/// Source: METHOD Eq. RG-12 to RG-21, RG-33 to RG-36.
struct ChainEffect {
  enum class Spring : std::uint8_t {
    kNone,
    kSofteningShoulder,   ///< RG-14
    kHardeningGrip,       ///< RG-15
    kOneWayShoulder,      ///< RG-16
    kSlackHarness,        ///< RG-17
    kBumpStop,            ///< RG-17
    kTighteningArm,       ///< RG-18
    kArmRest,             ///< RG-19
    kCogging,             ///< RG-20
    kDelayedReflex,       ///< RG-33
    kArmDrag,             ///< RG-34
    kStickDrag,           ///< RG-34
    kFractionalShoulder,  ///< RG-35
    kVibrationGrip,       ///< RG-36
  };

  Spring spring = Spring::kNone;
  double threshold_m = 1.0;   ///< RG-14, 15, 17, 36
  double factor = 0.0;        ///< RG-14 to RG-18, 36 [-]
  double time_s = 1.0;        ///< RG-18, 33, 36
  double rest_mass_kg = 1.0;  ///< RG-19
  double rest_frequency_hz = 1.0;
  double rest_damping = 0.1;  ///< damping ratio [-]
  double pad_stiffness_n_m = 0.0;
  double ripple_n = 0.0;         ///< RG-20
  double ripple_period_m = 1.0;  ///< at the hand
  double ripple_phase_rad = 0.0;
  double friction_n = 0.0;  ///< in addition to F_c of Eq. RG-4, RG-21
  double outside = 0.0;     ///< RG-33 [N/m], RG-34 [N s^2/m^2], RG-35 [N s^a/m]
  double exponent = 0.5;    ///< RG-35 [-]
};

/// A further mass next to the arm; arm and platform drive its motion.  Source: METHOD Eq. RG-19.
class RestMode {
 public:
  RestMode(const ChainEffect& effect, double period_s);
  [[nodiscard]] double position_m() const noexcept { return position_m_; }
  /// Advances one tick; both inputs are means over the tick.
  void step(double arm_m, double acceleration_m_s2) noexcept;

 private:
  signal::SecondOrderLag lag_;
  double stiffness_n_m_;
  double pad_n_m_;
  double mass_kg_;
  double position_m_ = 0.0;
};

/// The effect on one chain: that of the moving stick or that of a stick held at 0.
/// Pure: no clock, no I/O; never allocates or throws.
class EffectOnChain {
 public:
  EffectOnChain(const ChainEffect& effect, double period_s);

  [[nodiscard]] bool acts() const noexcept { return effect_.spring != ChainEffect::Spring::kNone; }
  /// Advances the time by one tick, Eq. RG-18.
  void age() noexcept { slack_left_ *= keep_; }
  /// Forces for the chain at `at`, with the present parameters `p` of the muscles.
  [[nodiscard]] ChainForces forces(const ChainPlace& at, const ChainParameters& p) const noexcept;
  /// Moves the mass of Eq. RG-19, and what RG-33 to RG-36 remember, over the tick in which the
  /// chain goes from `from` to `to`.
  void move(const ChainPlace& from, const ChainPlace& to, double mean_acceleration_m_s2) noexcept;

 private:
  ChainEffect effect_;
  RestMode rest_;
  double keep_;              ///< exp(-dt / time_s)
  double slack_left_ = 1.0;  ///< exp(-t / time_s)
  signal::DelayLine reflex_;
  double late_m_ = 0.0;  ///< stretch and rate of the shoulder, behind the delay of RG-33
  FractionalLadder ladder_;
  double vibration_m2_ = 0.0;  ///< running mean square of the grip's stretch, RG-36
};

}  // namespace stillhand::rig

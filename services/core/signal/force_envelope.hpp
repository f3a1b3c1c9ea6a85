// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "services/core/contract/config_field.hpp"
#include "services/core/contract/flag.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::signal {

/// Limits of a motor force at the hand.  They come from the process's own start-up settings; no
/// message or recording can change them.
struct ForceLimits {
  double max_force_n = 25.0;     ///< [N] magnitude never exceeded
  double max_slew_n_s = 2000.0;  ///< [N/s] magnitude of the rate of change while permitted
  std::int64_t ramp_ticks = 40;  ///< [ticks] from any force to zero once not permitted

  template <typename Visitor, typename Self>
  static void fields(Visitor&& visit, Self& self) {
    visit("max_force_n", self.max_force_n, Range{0.0, 60.0},
          "[N] largest motor force at the hand; 60 N is what the 150 W motor gives at stall");
    visit("max_slew_n_s", self.max_slew_n_s, Range{1.0, 20000.0},
          "[N/s] fastest change of the motor force; a 4 Hz, 25 N sinusoid needs 630 N/s");
    visit("ramp_ticks", self.ramp_ticks, Range{1.0, 50.0},
          "[ticks] time from any force to zero after the permission ends; at most 50 ms");
  }
};

/// The last thing every force passes through: bounded, slew-limited, and zero within `ramp_ticks`
/// of losing its permission, Eq. SG-6:
///
///   permitted:  f[n] = f[n-1] + clip(clip(u[n], F) - f[n-1], S dt)
///   otherwise:  f[n] = f[n-1] - f0 / R        for R ticks, then exactly 0
///
/// with F max_force_n, S max_slew_n_s, R ramp_ticks and f0 the force when the permission ended.
/// A NaN or infinite u counts as not permitted.  Pure; never allocates or throws.
class ForceEnvelope {
 public:
  struct Output {
    double force_n;  ///< [N] at the hand, same sign as asked
    Flags flags;     ///< kSaturated, kSlewLimited, kInputInvalid, kRampingDown
  };

  /// @throws stillhand::ConfigError when a limit is outside its range.
  explicit ForceEnvelope(const ForceLimits& limits) : limits_(limits) {
    validate(limits, "force_limits");
  }

  /// One tick.  @param wanted_n [N] force asked for  @param permitted  false sends it to zero
  Output step(double wanted_n, bool permitted) noexcept {
    Flags flags = kGood;
    if (!std::isfinite(wanted_n)) {
      flags |= kInputInvalid;
      permitted = false;
    }
    if (!permitted) return {ramp_down(flags), flags};
    ramp_left_ = 0;
    const double clipped = std::clamp(wanted_n, -limits_.max_force_n, limits_.max_force_n);
    if (clipped != wanted_n) flags |= kSaturated;
    const double max_change_n = limits_.max_slew_n_s * kControlPeriod_s;
    const double change_n = std::clamp(clipped - force_n_, -max_change_n, max_change_n);
    if (change_n != clipped - force_n_) flags |= kSlewLimited;
    force_n_ = std::clamp(force_n_ + change_n, -limits_.max_force_n, limits_.max_force_n);
    return {force_n_, flags};
  }

  [[nodiscard]] const ForceLimits& limits() const noexcept { return limits_; }

 private:
  double ramp_down(Flags& flags) noexcept {
    if (force_n_ == 0.0) return 0.0;
    flags |= kRampingDown;
    if (ramp_left_ == 0) {
      ramp_left_ = limits_.ramp_ticks;
      ramp_step_n_ = force_n_ / static_cast<double>(limits_.ramp_ticks);
    }
    --ramp_left_;
    force_n_ = ramp_left_ == 0 ? 0.0 : ramp_step_n_ * static_cast<double>(ramp_left_);
    return force_n_;
  }

  ForceLimits limits_;
  double force_n_ = 0.0;
  double ramp_step_n_ = 0.0;
  std::int64_t ramp_left_ = 0;
};

}  // namespace stillhand::signal

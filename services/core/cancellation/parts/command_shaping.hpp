// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/signal/biquad.hpp"

namespace stillhand::cancellation {

/// A filter on the command that knows nothing of the platform.
struct ShapingConfig {
  enum class Kind : std::uint8_t { kLowPass, kNotch };
  Kind kind = Kind::kLowPass;
  double frequency_hz = 1.0;   ///< corner, or middle of the notch
  double damping_ratio = 0.7;  ///< z; a notch is as wide as it is large
};

/// Filters the stick's command, METHOD Eq. MI-1, w = 2 pi frequency_hz:
///
///   low-pass w^2/(s^2 + 2 z w s + w^2),   notch (s^2 + w^2)/(s^2 + 2 z w s + w^2)
///
/// by the bilinear transform with w prewarped.  The paper's section V names filters as the
/// alternative to the motor.  What the person wants passes the same filter and comes late.  The
/// first step gives its argument back, as if the stick had always been there: both kinds pass what
/// rests. Pure; step() never allocates or throws.
class CommandShaping {
 public:
  /// @throws stillhand::ConfigError unless 0.01 Hz <= frequency <= 100 Hz and 0.05 <= z <= 2.
  explicit CommandShaping(const ShapingConfig& config);

  double step(double theta_rad) noexcept {
    if (!started_) start(theta_rad);
    return section_.step(theta_rad);
  }
  /// The next step is a first one.
  void restart() noexcept { started_ = false; }

 private:
  void start(double theta_rad) noexcept;

  signal::Biquad section_;
  bool started_ = false;
};

}  // namespace stillhand::cancellation

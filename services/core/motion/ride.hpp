// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

#include "services/core/motion/harmonic_motion.hpp"
#include "services/core/motion/motion_profile.hpp"

namespace stillhand::motion {

/// A recorded ride as a periodic spectrum.  The part that the trial uses, less its mean (a sensor's
/// offset and gravity through a constant tilt are no motion), is continued at both ends by its
/// fading mirror image and then by rest, up to a length with the factors 2, 3 and 5, and
/// transformed.  Leaving out harmonics and evaluating the rest at 1 kHz is a band-limited
/// resampling without delay.
class Ride {
 public:
  /// @throws stillhand::ConfigError when the record is not finite, slower than twice the band's
  ///         upper edge, or shorter than the measured duration.
  explicit Ride(const MotionProfile& profile);

  /// The ride through a zero-phase band-pass, Eq. MO-14:
  ///
  ///   H(f) = 1 / (1 + (fc/f)^8) times 1 below 0.8 fh, a half cosine from 1 to 0 up to fh
  ///
  /// @param corner_hz  fc [Hz], -6 dB;  fh is the profile's band_high_hz
  [[nodiscard]] MotionSpectrum above(double corner_hz) const;

  /// Variance of the record over the measured part [(m/s^2)^2].
  [[nodiscard]] double variance() const noexcept { return variance_; }

 private:
  MotionSpectrum recorded_;  // up to fh, not filtered
  double high_hz_;
  double variance_ = 0.0;
};

}  // namespace stillhand::motion

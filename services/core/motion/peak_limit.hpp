// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/motion/harmonic_motion.hpp"

namespace stillhand::motion {

/// Largest magnitudes a periodic motion may reach.
struct PeakBounds {
  double accel_m_s2;  ///< [m/s^2]
  double position_m;  ///< [m]
};

/// Changes phases, never magnitudes, until the motion keeps its bounds: the spectrum stays in its
/// band and its RMS exact.  Each round clips acceleration and position on the grid, transforms what
/// the clipping changed and takes over its phases only, Eq. MO-13:
///
///   C_k <- |C_k| exp(j arg(C_k + Da_k - w_k^2 Dx_k)),  Da, Dx: spectra of clip(a) - a, clip(x) - x
///
/// Source: van der Ouderaa, Schoukens and Renneboog, "Peak factor minimization using a
/// time-frequency domain swapping algorithm", IEEE Trans. Instrum. Meas. 37(1), 1988; the position
/// bound is added here.  Between grid points a sum of harmonics up to w exceeds its largest grid
/// value at most by 1/cos(w h/2), Eq. MO-10 (Ehlich and Zeller, Math. Z. 86, 1964): the
/// grid is held to the bound times that cosine, so that the bound holds at all times.
/// @returns rounds that were needed, 0 when the phases could stay
/// @throws stillhand::ConfigError when the bounds are not met after kMaxRounds.
int limit_peaks(MotionSpectrum& spectrum, const PeakBounds& bounds);

inline constexpr int kMaxRounds = 200;

}  // namespace stillhand::motion

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/config_field.hpp"
#include "services/core/motion/harmonic_motion.hpp"
#include "services/core/motion/motion_profile.hpp"

namespace stillhand::motion {

/// Tones of a multisine motion without components of its own; as many as the paper's reference.
inline constexpr int kDefaultTones = 15;

// The designed excitations, as harmonics of the measured duration, so that every line holds whole
// cycles and the RMS of the measured part is that of the spectrum.  Phases are uniform, drawn from
// the profile's seed; the same profile gives the same bits.
// Each throws stillhand::ConfigError when the band holds no harmonic or a setting contradicts
// another.

/// Band noise, Eq. MO-11: C_k = rms sqrt(2/K) exp(j phi_k) for all K harmonics in the band.  One
/// amplitude for all rather than Rayleigh draws: no line is weak by chance, so a response is
/// estimated equally well at each, and the RMS is exact for every seed; by the central limit
/// theorem the samples still tend to a normal distribution (Pintelon and Schoukens, System
/// Identification, 2nd ed., section 2.6: random-phase multisine).  With band_order n > 0 the edges
/// roll off as a band-pass filter's, |C_k| ~ ((1 + (f_low/f)^2n)(1 + (f/f_high)^2n))^-1/2, down to
/// -40 dB.
MotionSpectrum band_noise(const MotionProfile& profile);

/// The profile's components as they are (sines, Eq. SG-1); without any, kDefaultTones equal sines
/// spaced geometrically over the band.  rms_m_s2 > 0 scales the whole.
MotionSpectrum multisine(const MotionProfile& profile);

/// ISO 8608 road at constant speed u, Eq. MO-12: displacement PSD G(n) = G0 (n/n0)^-2, n0 = 0.1
/// cycles/m, n = f/u, so that per hertz
///
///   G_x(f) = G0 n0^2 u / f^2,   G_a(f) = (2 pi f)^4 G_x(f),   |C_k| = sqrt(2 G_a(f_k) / T)
///
/// G0 of classes A to H: 16e-6 4^i m^3, geometric means of ISO 8608:2016, which describes
/// 0.011 < n < 2.83 cycles/m: the band must lie inside.  rms_m_s2 > 0 scales the whole.
MotionSpectrum road(const MotionProfile& profile);

/// Frequencies [Hz] at which ISO 8608 describes a road for a vehicle of this speed: 0.011 to 2.83
/// cycles/m times u.
Range road_band_hz(double speed_m_s) noexcept;

}  // namespace stillhand::motion

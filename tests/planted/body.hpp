// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <string>

#include "tests/planted/draw.hpp"
#include "tests/planted/filters.hpp"

namespace stillhand::planted {

/// Deviations of a spring from F = k z; with the defaults it is linear.
struct SpringLaw {
  double gap_m = 0.0;        ///< clearance each side, no force inside
  double hardening_m = 0.0;  ///< F = k z (1 + (z/h)^2); 0: off
  double softening_m = 0.0;  ///< F = k s tanh(z/s); 0: off
  double skew = 0.0;         ///< stiffness k (1 + skew) pushed, k (1 - skew) pulled
  double smooth_skew = 0.0;  ///< k (1 + skew tanh(z / skew_scale))
  double skew_scale_m = 1.0;
  double hysteretic = 0.0;  ///< share of the force that follows the Bouc-Wen variable, 0 .. 1
  double yield_m = 1.0;     ///< deflection at which that share yields
  double sharpness = 1.0;   ///< Bouc-Wen exponent n
};

struct Spring {
  double stiffness_n_m = 0.0;
  double damping_n_s_m = 0.0;
  SpringLaw law;
};

/// Attachment of a third mass.
enum class ModeSite { kNone, kTorso, kArm, kStick };

/// Torso on a seat, arm on the torso, hand on a stick that moves with the platform.  Lateral, +
/// right, z relative to the platform:
///
///   m_t z_t'' = -m_t a - F_seat(z_t) - F_shoulder(z_t - z_a)
///   m_a z_a'' = -m_a a + F_shoulder(z_t - z_a) - F_grip(z_a)
///   f = F_grip(z_a),   F(z) = k law(z) + c z'
/// The linear response has four poles.  At 0 Hz, f/a is about
/// -(m_a + m_t k_shoulder/(k_seat + k_shoulder)).  At its zeros, the notch, the torso swings while
/// the hand rests.  A third mass may hang on one of the three.  Source: README Eq. PL-1 and PL-2.
struct Body {
  double torso_kg = 0.0;
  double arm_kg = 0.0;
  Spring seat;
  Spring shoulder;
  Spring grip;
  ModeSite mode_site = ModeSite::kNone;
  double mode_kg = 0.0;
  double mode_rad_s = 0.0;
  double mode_damping = 0.0;  ///< ratio
};

/// Features of the linear response that a fit over 120 s can show.
struct BodyFigures {
  double dc_n_per_m_s2 = 0.0;  ///< negative
  double notch_hz = 0.0;
  double notch_depth = 0.0;  ///< |H(notch)| / |H(0)|
  double peak_hz = 0.0;      ///< beyond the notch
  double peak_height = 0.0;  ///< |H(peak)| / |H(0)|
};

/// f/a of the linear part, without the third mass [N per m/s^2].
std::complex<double> response(const Body& body, double frequency_hz);
BodyFigures figures_of(const Body& body);

/// A body drawn from the ranges of the README's table, until its response looks like those of the
/// paper's Fig. 4: 2.2 to 4.5 N per m/s^2 at rest, notch between 5 and 8 Hz, a small peak after it.
Body draw_body(Draw& draw);

/// Force and deflections; the deflections scale the effects in a spring.
struct Motion {
  Series force_n;
  double seat_rms_m = 0.0;
  double shoulder_rms_m = 0.0;
  double grip_rms_m = 0.0;
};

/// From rest, Runge-Kutta of order 4, one step a sample of `acceleration_m_s2`; between samples the
/// acceleration is interpolated cubically.
Motion simulate(const Body& body, const Series& acceleration_m_s2, double step_s);

}  // namespace stillhand::planted

// SPDX-License-Identifier: Apache-2.0
#include "tests/planted/body.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace stillhand::planted {
namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

// Torso z, v; arm z, v; third mass z, v; Bouc-Wen variable of seat, shoulder, grip [m].
using State = std::array<double, 9>;

constexpr double kSoftContact = 0.2;  // of the gap, where half the damping acts; assumed

double elastic_m(const SpringLaw& law, double z_m) {
  double z = z_m;
  if (law.gap_m > 0.0) z = std::abs(z) <= law.gap_m ? 0.0 : z - std::copysign(law.gap_m, z);
  double force = z;
  if (law.softening_m > 0.0) force = law.softening_m * std::tanh(z / law.softening_m);
  if (law.hardening_m > 0.0) force += z * (z / law.hardening_m) * (z / law.hardening_m);
  if (law.skew != 0.0) force *= 1.0 + std::copysign(law.skew, z);
  if (law.smooth_skew != 0.0) force *= 1.0 + law.smooth_skew * std::tanh(z / law.skew_scale_m);
  return force;
}

double force_of(const Spring& spring, double z_m, double v_m_s, double hysteretic_m) {
  const SpringLaw& law = spring.law;
  double contact = 1.0;
  if (law.gap_m > 0.0) {
    // Damping sets in with the penetration, Hunt and Crossley (1975): the force does not jump.
    const double penetration_m = std::max(0.0, std::abs(z_m) - law.gap_m);
    contact = penetration_m / (penetration_m + kSoftContact * law.gap_m);
  }
  const double elastic = elastic_m(law, z_m);
  const double mixed = law.hysteretic > 0.0
                           ? (1.0 - law.hysteretic) * elastic + law.hysteretic * hysteretic_m
                           : elastic;
  return spring.stiffness_n_m * mixed + contact * spring.damping_n_s_m * v_m_s;
}

// Bouc (1967), Wen (1976), with beta = gamma = 1/2.
double hysteretic_rate(const SpringLaw& law, double v_m_s, double hysteretic_m) {
  if (law.hysteretic <= 0.0) return 0.0;
  const double share = std::pow(std::abs(hysteretic_m) / law.yield_m, law.sharpness);
  return v_m_s * (1.0 - share * (v_m_s * hysteretic_m > 0.0 ? 1.0 : 0.0));
}

struct Forces {
  double seat_n, shoulder_n, grip_n, mode_n, stick_n;
};

Forces forces_at(const Body& body, const State& x) {
  Forces out{};
  out.seat_n = force_of(body.seat, x[0], x[1], x[6]);
  out.shoulder_n = force_of(body.shoulder, x[0] - x[2], x[1] - x[3], x[7]);
  out.grip_n = force_of(body.grip, x[2], x[3], x[8]);
  if (body.mode_site != ModeSite::kNone) {
    const bool torso = body.mode_site == ModeSite::kTorso;
    const bool arm = body.mode_site == ModeSite::kArm;
    const double base_m = torso ? x[0] : arm ? x[2] : 0.0;
    const double base_m_s = torso ? x[1] : arm ? x[3] : 0.0;
    const double w = body.mode_rad_s;
    out.mode_n =
        body.mode_kg * (w * w * (x[4] - base_m) + 2.0 * body.mode_damping * w * (x[5] - base_m_s));
  }
  out.stick_n = out.grip_n + (body.mode_site == ModeSite::kStick ? out.mode_n : 0.0);
  return out;
}

State slope(const Body& body, const State& x, double a_m_s2) {
  const Forces f = forces_at(body, x);
  const double on_torso = body.mode_site == ModeSite::kTorso ? f.mode_n : 0.0;
  const double on_arm = body.mode_site == ModeSite::kArm ? f.mode_n : 0.0;
  State d{};
  d[0] = x[1];
  d[1] = -a_m_s2 + (on_torso - f.seat_n - f.shoulder_n) / body.torso_kg;
  d[2] = x[3];
  d[3] = -a_m_s2 + (on_arm + f.shoulder_n - f.grip_n) / body.arm_kg;
  if (body.mode_site != ModeSite::kNone) {
    d[4] = x[5];
    d[5] = -a_m_s2 - f.mode_n / body.mode_kg;
  }
  d[6] = hysteretic_rate(body.seat.law, x[1], x[6]);
  d[7] = hysteretic_rate(body.shoulder.law, x[1] - x[3], x[7]);
  d[8] = hysteretic_rate(body.grip.law, x[3], x[8]);
  return d;
}

State moved(const State& x, const State& d, double by_s) {
  State out;
  for (std::size_t i = 0; i < x.size(); ++i) out[i] = x[i] + by_s * d[i];
  return out;
}

double midway(const Series& a, std::size_t i) {
  if (i == 0 || i + 2 >= a.size()) return i + 1 < a.size() ? 0.5 * (a[i] + a[i + 1]) : a[i];
  return (9.0 * (a[i] + a[i + 1]) - a[i - 1] - a[i + 2]) / 16.0;
}

}  // namespace

std::complex<double> response(const Body& body, double frequency_hz) {
  const std::complex<double> s(0.0, kTwoPi * frequency_hz);
  const auto impedance = [&](const Spring& spring) {
    return spring.stiffness_n_m + spring.damping_n_s_m * s;
  };
  const auto seat = impedance(body.seat);
  const auto shoulder = impedance(body.shoulder);
  const auto grip = impedance(body.grip);
  const auto torso = body.torso_kg * s * s + seat + shoulder;
  const auto arm = body.arm_kg * s * s + shoulder + grip;
  return -grip * (body.arm_kg * torso + body.torso_kg * shoulder) /
         (torso * arm - shoulder * shoulder);
}

BodyFigures figures_of(const Body& body) {
  BodyFigures out{.dc_n_per_m_s2 = response(body, 0.0).real()};
  const double dc = std::abs(out.dc_n_per_m_s2);
  out.notch_depth = 1e9;
  for (double hz = 4.0; hz <= 10.0; hz += 0.02) {
    const double gain = std::abs(response(body, hz)) / dc;
    if (gain < out.notch_depth) {
      out.notch_depth = gain;
      out.notch_hz = hz;
    }
  }
  for (double hz = out.notch_hz; hz <= 25.0; hz += 0.05) {
    const double gain = std::abs(response(body, hz)) / dc;
    if (gain > out.peak_height) {
      out.peak_height = gain;
      out.peak_hz = hz;
    }
  }
  return out;
}

Body draw_body(Draw& draw) {
  for (;;) {
    Body body;
    body.torso_kg = draw.uniform(10.0, 30.0);
    body.arm_kg = draw.uniform(0.8, 2.2);
    const double seat_rad_s = kTwoPi * draw.uniform(1.5, 4.5);
    body.seat.stiffness_n_m = body.torso_kg * seat_rad_s * seat_rad_s;
    body.seat.damping_n_s_m = 2.0 * draw.uniform(0.2, 0.45) * body.torso_kg * seat_rad_s;
    body.shoulder.stiffness_n_m = draw.uniform(400.0, 2000.0);
    body.shoulder.damping_n_s_m =
        2.0 * draw.uniform(0.05, 0.25) * std::sqrt(body.shoulder.stiffness_n_m * body.arm_kg);
    body.grip.stiffness_n_m = draw.log_uniform(1500.0, 8000.0);
    body.grip.damping_n_s_m =
        2.0 * draw.uniform(0.1, 0.35) * std::sqrt(body.grip.stiffness_n_m * body.arm_kg);
    const BodyFigures figures = figures_of(body);
    const double dc = -figures.dc_n_per_m_s2;
    if (dc > 2.2 && dc < 4.5 && figures.notch_hz > 5.0 && figures.notch_hz < 8.0 &&
        figures.notch_depth < 0.6 && figures.peak_height > 1.05 * figures.notch_depth &&
        figures.peak_height < 1.2 && figures.peak_hz < 20.0) {
      return body;
    }
  }
}

Motion simulate(const Body& body, const Series& acceleration_m_s2, double step_s) {
  Motion out;
  out.force_n.resize(acceleration_m_s2.size());
  State x{};
  double seat = 0.0;
  double shoulder = 0.0;
  double grip = 0.0;
  for (std::size_t i = 0; i < acceleration_m_s2.size(); ++i) {
    out.force_n[i] = forces_at(body, x).stick_n;
    seat += x[0] * x[0];
    shoulder += (x[0] - x[2]) * (x[0] - x[2]);
    grip += x[2] * x[2];
    const double now = acceleration_m_s2[i];
    const double next = i + 1 < acceleration_m_s2.size() ? acceleration_m_s2[i + 1] : now;
    const double half = midway(acceleration_m_s2, i);
    const State k1 = slope(body, x, now);
    const State k2 = slope(body, moved(x, k1, 0.5 * step_s), half);
    const State k3 = slope(body, moved(x, k2, 0.5 * step_s), half);
    const State k4 = slope(body, moved(x, k3, step_s), next);
    for (std::size_t j = 0; j < x.size(); ++j) {
      x[j] += step_s / 6.0 * (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]);
    }
  }
  const auto count = static_cast<double>(acceleration_m_s2.size());
  out.seat_rms_m = std::sqrt(seat / count);
  out.shoulder_rms_m = std::sqrt(shoulder / count);
  out.grip_rms_m = std::sqrt(grip / count);
  return out;
}

}  // namespace stillhand::planted

// SPDX-License-Identifier: Apache-2.0
#include "services/core/population/population.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "services/core/contract/clamp_fields.hpp"
#include "services/core/rig/parts/body_response.hpp"
#include "services/core/signal/random.hpp"

namespace stillhand::population {
namespace {

// Stream of the draws under the study's seed; the subject's index is added.
constexpr std::uint64_t kSubjectStream = 0x7375626a00000000;
// A deviate beyond this is drawn again, Eq. SU-1.
constexpr double kFarthestDeviate = 2.5;

// Shares of the body mass, Winter (2009) table 4.1.  Head, arms and trunk are 0.678, of which 0.6
// sways on a seat.  Upper arm, forearm and hand are 0.050, of which three tenths are felt at the
// hand.  The hand is 0.006, of which two thirds are on the handle.
constexpr double kTrunkShare = 0.40;
constexpr double kArmShare = 0.0147;
constexpr double kHandShare = 0.0040;

// Range of the rig's setting.
constexpr double kMostCocontraction = 4.0;

// Perception takes a millisecond at least.
constexpr double kShortest_s = 0.001;

using Draw = std::function<double(double mean, double cv)>;

double damping(double ratio, double stiffness_n_m, double mass_kg) {
  return 2.0 * ratio * std::sqrt(stiffness_n_m * mass_kg);
}

rig::BodyConfig body(const Population& p, const Draw& draw, rig::BodyConfig out) {
  const double mass_kg = draw(p.body_mass_kg, p.body_mass_cv);
  out.trunk_mass_kg = kTrunkShare * mass_kg;
  out.arm_mass_kg = kArmShare * mass_kg;
  out.hand_mass_kg = kHandShare * mass_kg;
  const double seat_rad_s = 2.0 * std::numbers::pi * draw(p.seat_frequency_hz, p.seat_frequency_cv);
  out.seat_stiffness_n_m = out.trunk_mass_kg * seat_rad_s * seat_rad_s;
  out.seat_damping_n_s_m = damping(draw(p.seat_damping_ratio, p.seat_damping_cv),
                                   out.seat_stiffness_n_m, out.trunk_mass_kg);
  out.shoulder_stiffness_n_m = draw(p.shoulder_stiffness_n_m, p.shoulder_stiffness_cv);
  out.shoulder_damping_n_s_m = damping(draw(p.shoulder_damping_ratio, p.shoulder_damping_cv),
                                       out.shoulder_stiffness_n_m, out.arm_mass_kg);
  out.grip_stiffness_n_m = draw(p.grip_stiffness_n_m, p.grip_stiffness_cv);
  out.grip_damping_n_s_m = damping(draw(p.grip_damping_ratio, p.grip_damping_cv),
                                   out.grip_stiffness_n_m, out.arm_mass_kg + out.hand_mass_kg);
  const double factor =
      std::clamp(draw(p.cocontraction_factor, p.cocontraction_cv), 1.0, kMostCocontraction);
  out.cocontraction_stiffness_factor = factor;
  out.cocontraction_damping_factor = std::sqrt(factor);
  return out;
}

rig::NeuromuscularConfig neuromuscular(const Population& p, const Draw& draw,
                                       rig::NeuromuscularConfig out) {
  out.stiffening_by_vibration_s2_m =
      draw(p.stiffening_by_vibration_s2_m, p.stiffening_by_vibration_cv);
  out.stiffening_by_motor_n = draw(p.stiffening_by_motor_n, p.stiffening_by_motor_cv);
  out.wander = draw(p.wander, p.wander_cv);
  out.reflex_stiffness_n_m = draw(p.reflex_stiffness_n_m, p.reflex_stiffness_cv);
  out.reflex_damping_n_s_m = out.reflex_stiffness_n_m * p.reflex_damping_time_s;
  out.motor_resistance = draw(p.motor_resistance, p.motor_resistance_cv);
  out.involuntary_force_n = draw(p.involuntary_force_n, p.involuntary_force_cv);
  out.tremor_force_n = draw(p.tremor_force_n, p.tremor_force_cv);
  out.unmeasured_force_n_s2_m = draw(p.unmeasured_force_n_s2_m, p.unmeasured_force_cv);
  settings::clamp_fields(out);
  return out;
}

Subject subject(const Population& p, const Draw& draw, Subject out, const rig::StickConfig& stick) {
  out.body = body(p, draw, out.body);
  out.who.crossover_hz = draw(p.crossover_hz, p.crossover_cv);
  out.who.delay_s = draw(p.delay_s, p.delay_cv);
  out.who.muscle_rad_s = draw(p.muscle_rad_s, p.muscle_cv);
  // The delay of the whole subject contains the lag of the muscle.
  out.who.delay_s = std::max(
      out.who.delay_s, 2.0 * out.who.muscle_damping_ratio / out.who.muscle_rad_s + kShortest_s);
  out.who.remnant_ratio = draw(p.remnant_ratio, p.remnant_cv);
  out.who.regression_error_m = draw(p.regression_error_m, p.regression_cv);
  // Later draws come last: a subject's body and tracking do not depend on them.
  out.body.neuromuscular = neuromuscular(p, draw, out.body.neuromuscular);
  out.who.remnant_by_vibration_s2_m = draw(p.remnant_by_vibration_s2_m, p.remnant_by_vibration_cv);
  out.who.delay_by_vibration_s3_m = draw(p.delay_by_vibration_s3_m, p.delay_by_vibration_cv);
  out.who.arm = learnt_feel(out.body, stick, out.who.arm);
  return out;
}

}  // namespace

human_operator::ArmFeel learnt_feel(const rig::BodyConfig& body, const rig::StickConfig& stick,
                                    human_operator::ArmFeel feel) {
  const auto impedance = [&](double hz) {
    return 1.0 / rig::hand_admittance(body, stick, false, hz);
  };
  // Eq. SU-2: K - M w^2 and B w, the first with K known from 0 Hz.
  feel.effective_stiffness_n_m = impedance(0.0).real();
  double w4 = 0.0;
  double w2 = 0.0;
  double mass_part = 0.0;
  double damping_part = 0.0;
  for (int step = 1; step <= 10; ++step) {
    const double w = 2.0 * std::numbers::pi * 0.1 * step;
    const auto z = impedance(0.1 * step);
    w2 += w * w;
    w4 += w * w * w * w;
    mass_part += (feel.effective_stiffness_n_m - z.real()) * w * w;
    damping_part += z.imag() * w;
  }
  feel.effective_mass_kg = mass_part / w4;
  feel.effective_damping_n_s_m = damping_part / w2;
  return feel;
}

Subject mean_subject(const Population& population) {
  validate(population, "population");
  return subject(population, [](double mean, double) { return mean; }, {}, {});
}

Subject draw_subject(const Population& population, std::uint64_t seed, std::int64_t index,
                     const Subject& base, const rig::StickConfig& stick) {
  validate(population, "population");
  signal::Gaussian deviate(seed, kSubjectStream + static_cast<std::uint64_t>(index));
  const Draw draw = [&](double mean, double cv) {
    double z = deviate();
    while (std::abs(z) > kFarthestDeviate) z = deviate();
    // Eq. SU-1: mean and standard deviation of the lognormal, before the cut.
    const double log_variance = std::log1p(cv * cv);
    return mean * std::exp(std::sqrt(log_variance) * z - 0.5 * log_variance);
  };
  return subject(population, draw, base, stick);
}

}  // namespace stillhand::population

// SPDX-License-Identifier: Apache-2.0
#include "tests/support/simulated_arm.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>

#include "services/core/population/population.hpp"

namespace stillhand::simulated {
namespace {

using Complex = std::complex<double>;
using Vector = Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kHandle_kg = 0.10;
constexpr double kDrive_kg = 0.25;
constexpr double kViscous_n_s_m = 0.5;
constexpr double kReflexTime_s = 0.125;
constexpr double kMuscle_rad_s = kTurn * 2.2;
constexpr double kMuscleDamping = 0.75;
constexpr double kHandCorner_hz = 2.0;

// Trunk, arm, hand with stick.
struct Matrices {
  Eigen::Matrix3d damping, stiffness;
  Vector mass;     // that moves
  Vector carried;  // on which the platform's acceleration acts
};

Eigen::Matrix3d between(int i, int j, double value) {
  Eigen::Matrix3d out = Eigen::Matrix3d::Zero();
  out(i, i) = out(j, j) = value;
  out(i, j) = out(j, i) = -value;
  return out;
}

Matrices matrices_of(const Values& v) {
  Matrices out;
  out.mass = {v[0], v[3], v[6] + kHandle_kg + kDrive_kg};
  out.carried = {v[0], v[3], v[6] + kHandle_kg};
  out.damping = between(0, 1, v[4]) + between(1, 2, v[7]);
  out.damping(0, 0) += v[1];
  out.damping(2, 2) += kViscous_n_s_m;
  out.stiffness = between(0, 1, v[5]) + between(1, 2, v[8]);
  out.stiffness(0, 0) += v[2];
  return out;
}

double sine_sum(const signal::Multisine& sine, double turns) {
  double sum = 0.0;
  for (const signal::Component& c : sine.components()) {
    sum +=
        c.amplitude_m_s2 * std::sin(kTurn * static_cast<double>(c.harmonic) * turns + c.phase_rad);
  }
  return sum;
}

std::vector<double> table_of(const signal::Multisine& sine, std::size_t points) {
  std::vector<double> out;
  for (std::size_t i = 0; i < points; ++i) {
    out.push_back(sine_sum(sine, static_cast<double>(i) / static_cast<double>(points)));
  }
  return out;
}

double largest(const std::vector<double>& values) {
  double out = 0.0;
  for (const double v : values) out = std::max(out, std::abs(v));
  return out;
}

struct State {
  Vector q = Vector::Zero(), v = Vector::Zero();
  double muscle = 0.0, muscle_rate = 0.0;
};

State sum(const State& a, double h, const State& rate) {
  return {a.q + h * rate.q, a.v + h * rate.v, a.muscle + h * rate.muscle,
          a.muscle_rate + h * rate.muscle_rate};
}

// The stretch of the shoulder and its rate, some time ago.
class Past {
 public:
  explicit Past(double step_s) : step_s_(step_s) {}
  void add(double stretch, double rate) {
    stretch_.push_back(stretch);
    rate_.push_back(rate);
  }
  // k_r's command per k_r at step n + part, delay_s ago; zero before the start.
  [[nodiscard]] double command(double step, double delay_s) const {
    const double at = step - delay_s / step_s_;
    if (at <= 0.0) return 0.0;
    const auto n = static_cast<std::size_t>(at);
    const double p = at - static_cast<double>(n);
    const double h00 = (1.0 + 2.0 * p) * (1.0 - p) * (1.0 - p);
    const double h01 = p * p * (3.0 - 2.0 * p);
    const double stretch =
        h00 * stretch_[n] + h01 * stretch_[n + 1] +
        step_s_ * (p * (1.0 - p) * (1.0 - p) * rate_[n] - p * p * (1.0 - p) * rate_[n + 1]);
    return stretch + kReflexTime_s * ((1.0 - p) * rate_[n] + p * rate_[n + 1]);
  }

 private:
  double step_s_;
  std::vector<double> stretch_, rate_;
};

class Stepper {
 public:
  Stepper(const Values& arm, double step_s)
      : arm_(arm), m_(matrices_of(arm)), step_s_(step_s), past_(step_s) {
    past_.add(0.0, 0.0);
  }
  // f: forces on the stick, a: acceleration; at the begin, middle and end of the step.
  void step(const std::array<double, 3>& f, const std::array<double, 3>& a) {
    const auto n = static_cast<double>(count_);
    const auto rate = [&](const State& x, int half) {
      return rate_at(x, f[half], a[half], past_.command(n + 0.5 * half, arm_[10]));
    };
    const State k1 = rate(x_, 0);
    const State k2 = rate(sum(x_, 0.5 * step_s_, k1), 1);
    const State k3 = rate(sum(x_, 0.5 * step_s_, k2), 1);
    const State k4 = rate(sum(x_, step_s_, k3), 2);
    x_ = sum(sum(sum(sum(x_, step_s_ / 6.0, k1), step_s_ / 3.0, k2), step_s_ / 3.0, k3),
             step_s_ / 6.0, k4);
    past_.add(x_.q[1] - x_.q[0], x_.v[1] - x_.v[0]);
    ++count_;
  }
  // Load cell, between hand and stick: what the drive's mass and the bearings need, less the motor.
  [[nodiscard]] double cell_n(double motor_n, double hand_n, double a) const {
    const State rate =
        rate_at(x_, motor_n + hand_n, a, past_.command(static_cast<double>(count_), arm_[10]));
    return kDrive_kg * rate.v[2] + kViscous_n_s_m * x_.v[2] - motor_n;
  }
  [[nodiscard]] double displacement_m() const { return x_.q[2]; }

 private:
  [[nodiscard]] State rate_at(const State& x, double force, double accel, double command) const {
    State out{.q = x.v};
    const Vector forces = -(m_.stiffness * x.q + m_.damping * x.v) - m_.carried * accel +
                          Vector(x.muscle, -x.muscle, force);
    out.v = forces.cwiseQuotient(m_.mass);
    out.muscle = x.muscle_rate;
    out.muscle_rate = kMuscle_rad_s * kMuscle_rad_s * (arm_[9] * command - x.muscle) -
                      2.0 * kMuscleDamping * kMuscle_rad_s * x.muscle_rate;
    return out;
  }

  Values arm_;
  Matrices m_;
  double step_s_;
  Past past_;
  State x_;
  std::int64_t count_ = 0;
};

}  // namespace

Values drawn_arm(std::uint64_t seed, std::int64_t index) {
  const auto body = population::draw_subject(population::Population{}, seed, index).body;
  const double stiffer = body.cocontraction_stiffness_factor;
  const double damped = body.cocontraction_damping_factor;
  std::mt19937_64 engine(seed * 7919 + static_cast<std::uint64_t>(index));
  std::uniform_real_distribution<double> uniform;
  const double reflex = 100.0 + 300.0 * uniform(engine);
  const double delay = 0.025 + 0.015 * uniform(engine);
  return {body.trunk_mass_kg,
          body.seat_damping_n_s_m,
          body.seat_stiffness_n_m,
          body.arm_mass_kg,
          damped * body.shoulder_damping_n_s_m,
          stiffer * body.shoulder_stiffness_n_m,
          body.hand_mass_kg,
          damped * body.grip_damping_n_s_m,
          stiffer * body.grip_stiffness_n_m,
          reflex,
          delay};
}

Truth truth_at(const Values& arm, double frequency_hz) {
  const Matrices m = matrices_of(arm);
  const Complex s(0.0, kTurn * frequency_hz);
  const Complex reflex =
      arm[9] * (1.0 + kReflexTime_s * s) * std::exp(-s * arm[10]) /
      (1.0 + 2.0 * kMuscleDamping * s / kMuscle_rad_s + s * s / (kMuscle_rad_s * kMuscle_rad_s));
  Eigen::Matrix3cd dynamic = m.stiffness + s * m.damping;
  dynamic += s * s * m.mass.asDiagonal().toDenseMatrix();
  dynamic += reflex * between(0, 1, 1.0);
  const Eigen::PartialPivLU<Eigen::Matrix3cd> lu(dynamic);
  const Complex of_force = lu.solve(Eigen::Vector3cd(0.0, 0.0, 1.0))[2];
  const Complex of_accel = lu.solve(Eigen::Vector3cd(-m.carried.cast<Complex>()))[2];
  const Complex drive = kDrive_kg * s * s + kViscous_n_s_m * s;
  Truth out;
  out.x_per_force = of_force;
  out.f_per_force = drive * of_force - 1.0;
  out.x_per_accel = of_accel;
  out.f_per_accel = drive * of_accel;
  out.admittance = -out.x_per_force / out.f_per_force;
  return out;
}

Run run(const Values& arm, const admittance::Excitation& excitation, double rate_hz,
        std::int64_t periods, const Noise& noise, std::uint64_t seed) {
  const auto samples = static_cast<std::size_t>(excitation.force.samples_per_period());
  const std::vector<double> force = table_of(excitation.force, 4 * samples);
  const std::vector<double> accel = table_of(excitation.motion, 4 * samples);
  const double step_s = 0.5 / rate_hz;
  const double kept = std::exp(-kTurn * kHandCorner_hz * step_s);
  std::mt19937_64 engine(seed);
  std::normal_distribution<double> normal;
  Stepper stepper(arm, step_s);
  Run out;
  out.record.rate_hz = rate_hz;
  out.largest_force_n = largest(force);
  out.largest_acceleration_m_s2 = largest(accel);
  double hand = noise.hand_force_n * normal(engine);
  const std::size_t count = (static_cast<std::size_t>(periods) + 1) * 2 * samples;
  for (std::size_t n = 0; n < count; ++n) {
    const std::size_t i = 2 * n % force.size();
    const std::size_t j = (i + 2) % force.size();
    if (n % 2 == 0 && n >= 2 * samples) {
      out.record.motor_force_n.push_back(force[i]);
      out.record.acceleration_m_s2.push_back(accel[i] + noise.acceleration_m_s2 * normal(engine));
      out.record.displacement_m.push_back(stepper.displacement_m() +
                                          noise.displacement_m * normal(engine));
      out.record.hand_force_n.push_back(stepper.cell_n(force[i], hand, accel[i]) +
                                        noise.force_n * normal(engine));
    }
    stepper.step({force[i] + hand, force[i + 1] + hand, force[j] + hand},
                 {accel[i], accel[i + 1], accel[j]});
    hand = kept * hand + std::sqrt(1.0 - kept * kept) * noise.hand_force_n * normal(engine);
  }
  return out;
}

}  // namespace stillhand::simulated

// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/linear_arm.hpp"

#include <algorithm>
#include <complex>
#include <numbers>
#include <string>
#include <unsupported/Eigen/MatrixFunctions>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::cancellation {
namespace {

using admittance::ArmValues;

// States of the chain with N masses (3: the stick is free): positions, speeds, muscle, delay.
template <int N>
struct Continuous {
  static constexpr int kStates = 2 * N + 4;
  Eigen::Matrix<double, kStates, kStates> a = Eigen::Matrix<double, kStates, kStates>::Zero();
  Eigen::Matrix<double, kStates, 2> b = Eigen::Matrix<double, kStates, 2>::Zero();

  // Force between masses i and j per k distance + c speed, on the speed rows; j < 0: to the ground.
  void spring(int i, int j, double k, double c, double mass) {
    a(N + i, i) -= k / mass;
    a(N + i, N + i) -= c / mass;
    if (j < 0) return;
    a(N + i, j) += k / mass;
    a(N + i, N + j) += c / mass;
  }
};

// Eq. MI-4.
template <int N>
Continuous<N> continuous(const ArmValues& v,
                         [[maybe_unused]] const admittance::StickValues& stick) {
  using namespace admittance;
  Continuous<N> out;
  [[maybe_unused]] const double stick_kg = v[kCellMass] + stick.drive_mass_kg;
  out.a.template block<N, N>(0, N).setIdentity();
  out.spring(0, -1, v[kSeatStiffness], v[kSeatDamping], v[kTrunkMass]);
  out.spring(0, 1, v[kArmStiffness], v[kArmDamping], v[kTrunkMass]);
  out.spring(1, 0, v[kArmStiffness], v[kArmDamping], v[kArmMass]);
  out.spring(1, N == 3 ? 2 : -1, v[kGripStiffness], v[kGripDamping], v[kArmMass]);
  out.b(N, 0) = out.b(N + 1, 0) = -1.0;
  if constexpr (N == 3) {
    out.spring(2, 1, v[kGripStiffness], v[kGripDamping], stick_kg);
    out.spring(2, -1, stick.centring_stiffness_n_m, stick.viscous_damping_n_s_m, stick_kg);
    out.b(N + 2, 0) = -v[kCellMass] / stick_kg;
    out.b(N + 2, 1) = 1.0 / stick_kg;
  }
  // Reflex: the delay's state p of the command u, p'' = 12/tau^2 (u - p) - 6/tau p', answers
  // u - tau p'; the muscle follows it and pulls arm and trunk together.
  constexpr int kMuscle = 2 * N;
  constexpr int kDelay = 2 * N + 2;
  const double tau = std::max(v[kReflexDelay], 1e-3);
  const double w = 2.0 * std::numbers::pi * std::max(v[kMuscleFrequency], 0.1);
  const auto add_command = [&](int row, double gain) {
    out.a(row, 1) += gain * v[kReflexStiffness];
    out.a(row, 0) -= gain * v[kReflexStiffness];
    out.a(row, N + 1) += gain * v[kReflexDamping];
    out.a(row, N) -= gain * v[kReflexDamping];
  };
  out.a(kMuscle, kMuscle + 1) = 1.0;
  out.a(kMuscle + 1, kMuscle) = -w * w;
  out.a(kMuscle + 1, kMuscle + 1) = -2.0 * admittance::kMuscleDamping * w;
  add_command(kMuscle + 1, w * w);
  out.a(kMuscle + 1, kDelay + 1) = -w * w * tau;
  out.a(kDelay, kDelay + 1) = 1.0;
  out.a(kDelay + 1, kDelay) = -12.0 / (tau * tau);
  out.a(kDelay + 1, kDelay + 1) = -6.0 / tau;
  add_command(kDelay + 1, 12.0 / (tau * tau));
  out.a(N, kMuscle) += 1.0 / v[kTrunkMass];
  out.a(N + 1, kMuscle) -= 1.0 / v[kArmMass];
  return out;
}

// exp of [A B; 0 0] over one tick holds both matrices of a step with held inputs.
template <int N>
Eigen::MatrixXd stepped(const Continuous<N>& system) {
  constexpr int kStates = Continuous<N>::kStates;
  if (!system.a.allFinite() || !system.b.allFinite()) {
    throw ConfigError("mitigation.arm", "a value out of range", "finite values of a person's size");
  }
  // Written so that poles that were not found say "not stable".
  const bool rests = std::ranges::all_of(signal::eigenvalues(system.a),
                                         [](const auto& pole) { return pole.real() < 0.0; });
  if (!rests) {
    throw ConfigError("mitigation.arm", "an arm that does not come to rest", "a stable arm");
  }
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(kStates + 2, kStates + 2);
  all.topLeftCorner(kStates, kStates) = system.a * kControlPeriod_s;
  all.topRightCorner(kStates, 2) = system.b * kControlPeriod_s;
  const Eigen::MatrixXd out = all.exp();
  if (!out.allFinite()) {
    throw ConfigError("mitigation.arm", "an arm too fast for steps of 1 ms", "a person's arm");
  }
  return out.topRows(kStates);
}

}  // namespace

LinearArm::LinearArm(const ArmValues& arm, const admittance::StickValues& stick)
    : grip_stiffness_n_m_(arm[admittance::kGripStiffness]),
      grip_damping_n_s_m_(arm[admittance::kGripDamping]),
      cell_mass_kg_(arm[admittance::kCellMass]) {
  for (const auto mass : {admittance::kTrunkMass, admittance::kArmMass, admittance::kCellMass}) {
    if (!(arm[mass] > 0.0)) {
      throw ConfigError("mitigation.arm", std::to_string(arm[mass]) + " kg", "masses above 0");
    }
  }
  const Eigen::MatrixXd loose = stepped(continuous<3>(arm, stick));
  const Eigen::MatrixXd tight = stepped(continuous<2>(arm, stick));
  free_step_ = loose.leftCols(kFree);
  free_input_ = loose.rightCols(2);
  held_step_ = tight.leftCols(kHeld);
  held_input_ = tight.col(kHeld);
  reset();
}

ArmPrediction LinearArm::step(double accel_m_s2, double motor_n) noexcept {
  const ArmPrediction now{
      grip_stiffness_n_m_ * held_[1] + grip_damping_n_s_m_ * held_[3] - cell_mass_kg_ * accel_m_s2,
      free_[2]};
  held_ = (held_step_ * held_ + held_input_ * accel_m_s2).eval();
  free_ =
      (free_step_ * free_ + free_input_.col(0) * accel_m_s2 + free_input_.col(1) * motor_n).eval();
  return now;
}

void LinearArm::reset() noexcept {
  free_.setZero();
  held_.setZero();
}

}  // namespace stillhand::cancellation

// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/parts/stick_impedance.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include "services/core/cancellation/parts/part_step.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

void need(bool good, const char* key, double got, const char* want) {
  if (!good) throw ConfigError(key, std::to_string(got), want);
}

}  // namespace

StickImpedance::StickImpedance(const ImpedanceConfig& config) : config_(config) {
  need(config.stiffness_n_m >= 0.0 && config.stiffness_n_m <= 5000.0, "impedance.stiffness_n_m",
       config.stiffness_n_m, "0 to 5000 N/m");
  // The delay of hold and motor takes K tau off the damping of the stick, 0.5 N s/m, and the part.
  constexpr double kDelay_s = 0.002, kStickDamping_n_s_m = 0.5;
  need(config.stiffness_n_m * kDelay_s <= config.damping_n_s_m + kStickDamping_n_s_m,
       "impedance.stiffness_n_m", config.stiffness_n_m,
       "what the damping bears on a stick that nobody holds: 250 N/m, and 500 N/m for each N s/m");
  need(config.damping_n_s_m >= 0.0 && config.damping_n_s_m <= 200.0, "impedance.damping_n_s_m",
       config.damping_n_s_m, "0 to 200 N s/m");
  need(config.mass_kg >= 0.0 && config.mass_kg <= 0.8, "impedance.mass_kg", config.mass_kg,
       "0 to 0.8 kg: a stick that nobody holds oscillates with 1.1");
  need(config.lever_m > 0.0 && config.lever_m <= 1.0, "impedance.lever_m", config.lever_m,
       "above 0, at most 1 m");
}

double StickImpedance::step(double theta_rad, double omega_rad_s) noexcept {
  constexpr double kRate_rad_s = 2.0 * std::numbers::pi * kInertiaCorner_hz;
  const double x_m = config_.lever_m * theta_rad;
  const double v_m_s = config_.lever_m * omega_rad_s;
  const double a_m_s2 = kRate_rad_s * (v_m_s - slow_m_s_);
  slow_m_s_ += kControlPeriod_s * a_m_s2;
  // Eq. MI-2.
  return -(config_.stiffness_n_m * x_m + config_.damping_n_s_m * v_m_s + config_.mass_kg * a_m_s2);
}

namespace {
class ImpedanceStep : public StepOf<ImpedanceStep> {
 public:
  explicit ImpedanceStep(const ImpedanceConfig& config) : impedance_(config) {}
  double force_n(const Moment& now) noexcept override {
    const double wanted_n = impedance_.step(now.theta_rad, now.omega_rad_s);
    // While the motor rests, the stick's ringing is not the part's.
    if (now.motor_n == 0.0 && !oscillation_.found()) oscillation_.reset();
    return oscillation_.step(now.theta_rad) ? 0.0 : wanted_n;
  }

 private:
  StickImpedance impedance_;
  signal::GrowingOscillation oscillation_{kOscillation};
};
}  // namespace

std::unique_ptr<PartStep> make_impedance(const Part& part) {
  return std::make_unique<ImpedanceStep>(ImpedanceConfig{
      .mass_kg = part.values[2], .damping_n_s_m = part.values[1], .stiffness_n_m = part.values[0]});
}

}  // namespace stillhand::cancellation

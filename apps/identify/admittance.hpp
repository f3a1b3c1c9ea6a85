// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "apps/report/plot/figure.hpp"
#include "services/admittance/core/arm_fit.hpp"
#include "services/admittance/core/session_excitation.hpp"

namespace stillhand::identify {

/// What a session's perturbed trial says of the arm.
struct AdmittanceResult {
  std::string recording;
  admittance::SessionPerturbation perturbation;
  std::int64_t periods = 0;      ///< used, without the first
  std::int64_t lost_ticks = 0;   ///< among them; the last sample before is held
  double largest_force_n = 0.0;  ///< of the motor's commands
  admittance::LineEstimates lines;
  admittance::ArmFit arm;
};

/// Reads the last perturbed trial (`stillhand lab --identify admittance,feedthrough`) of a session.
/// Displacement and motor command pass the low-pass of sensing, as acceleration and force did.
/// @param lever_m  hand to pivot
/// @throws stillhand::ConfigError when there is no such trial, or one tick in a thousand is lost.
AdmittanceResult identify_admittance(const std::string& recording, double lever_m);

/// README, "Admittance: out.json".
std::string result_json(const AdmittanceResult& result);
std::string result_table(const AdmittanceResult& result);
/// Magnitude and phase of the three responses with their 95 % bands, next to the fitted arm.
report::Figure figure(const AdmittanceResult& result);

}  // namespace stillhand::identify

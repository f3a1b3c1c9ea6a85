// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/report/plot/figure.hpp"
#include "services/core/admittance/arm_fit.hpp"
#include "services/core/admittance/relation.hpp"
#include "services/core/admittance/session_excitation.hpp"

namespace stillhand::identify {

/// Sessions of `stillhand lab --identify admittance,feedthrough` with one period and seed.
struct AdmittanceRecordings {
  std::string free;
  /// For the relation (AD-16), both or neither: with --held-stick, and with --swap-lines.
  std::string held, swapped;
};

/// What a session's perturbed trial says of the arm.
struct AdmittanceResult {
  std::string recording;
  admittance::SessionPerturbation perturbation;
  std::int64_t periods = 0;      ///< used, without the first
  std::int64_t lost_ticks = 0;   ///< among them; the last sample before is held
  double largest_force_n = 0.0;  ///< of the motor's commands
  admittance::LineEstimates lines;
  admittance::ArmFit arm;
  std::vector<admittance::LineResponse> held_feedthrough;  ///< F/A of the held stick, or empty
  std::optional<admittance::RelationTest> relation;
};

/// Reads the last perturbed trial of each session.  Displacement and motor command pass the
/// low-pass of sensing, as acceleration and force did.
/// @param lever_m  hand to pivot
/// @throws stillhand::ConfigError when there is no such trial, one tick in a thousand is lost, or
///         the sessions do not belong together.
AdmittanceResult identify_admittance(const AdmittanceRecordings& recordings, double lever_m);

/// README, "Admittance: out.json".
std::string result_json(const AdmittanceResult& result);
std::string result_table(const AdmittanceResult& result);
/// Magnitude and phase of the three responses with their 95 % bands, next to the fitted arm.
report::Figure figure(const AdmittanceResult& result);

}  // namespace stillhand::identify

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "services/core/admittance/interleaved_multisines.hpp"

namespace stillhand::admittance {

/// What a session over DDS says of its perturbation; the processes design it each for itself.
struct SessionPerturbation {
  double period_s = 0.0;   ///< [s] of both multisines; 0: none
  std::uint64_t seed = 1;  ///< of the phases
  bool swapped = false;    ///< the platform takes the lines of the motor, and the reverse
};

/// Settings for 1 kHz: from one cycle in the period, not below 0.05 Hz, to 20 Hz, with as many
/// lines as the band has room for, at most 20 of each; the rest are the defaults.
/// @throws stillhand::ConfigError for a period outside 2 to 200 s or of no whole number of ticks.
ExcitationConfig session_excitation(const SessionPerturbation& perturbation);

/// The platform's lines as harmonics of a trial of whole periods, for a motion profile.
/// @throws stillhand::ConfigError when the trial is not a whole number of periods, five or more:
///         the first is left out of the analysis, which needs four.
std::vector<signal::Component> motion_components(const SessionPerturbation& perturbation,
                                                 std::int64_t duration_ticks);

/// As text for an event in the recording, and back; a text of anything else gives none (period 0).
std::string in_words(const SessionPerturbation& perturbation);
SessionPerturbation perturbation_in(const std::string& words);

}  // namespace stillhand::admittance

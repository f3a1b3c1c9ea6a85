// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace stillhand::planted {

/// Kinds of planted effects.  The names equal those of the verdicts.  They are defined again here,
/// because the simulator must not share code with the engine that it tests.
enum class Kind {
  kDelay,
  kResonance,
  kCoupledInput,
  kCoulombFriction,
  kNonlinearStiffness,
  kAsymmetry,
  kHysteresis,
  kDeadZone,
  kOutputSaturation,
  kInputSaturation,
  kPositionRipple,
  kTone,
  kDrift,
  kTimeVaryingGain,
  kRegimeChange,
  kClockDrift,
  kBilinear,
  kTransients,
};

inline constexpr auto kKindNames = std::to_array<std::string_view>(
    {"delay", "resonance", "coupled_input", "coulomb_friction", "nonlinear_stiffness", "asymmetry",
     "hysteresis", "dead_zone", "output_saturation", "input_saturation", "position_ripple", "tone",
     "drift", "time_varying_gain", "regime_change", "clock_drift", "bilinear", "transients"});

inline std::string_view name_of(Kind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

inline std::optional<Kind> kind_of(std::string_view name) {
  for (std::size_t i = 0; i < kKindNames.size(); ++i) {
    if (kKindNames[i] == name) return static_cast<Kind>(i);
  }
  return std::nullopt;
}

}  // namespace stillhand::planted

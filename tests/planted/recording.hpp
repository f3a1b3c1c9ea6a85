// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tests/planted/body.hpp"
#include "tests/planted/effect.hpp"
#include "tests/planted/noise.hpp"
#include "tests/planted/scene.hpp"

namespace stillhand::planted {

/// Requested properties; all others are drawn.
struct Spec {
  std::vector<Kind> kinds;             ///< empty: no effect
  std::vector<double> strengths{0.1};  ///< of each kind; the last one applies to all further kinds
  double snr_db = 20.0;                ///< noise-free force over noise
  /// Effects, and then body and ride, are drawn again until each effect alone reaches this
  /// Truth::evidence; 0: accepts every draw.  An effect that the baseline absorbs is not missing.
  double least_evidence = 0.0;
  double length_s = 120.0;
  double rate_hz = 100.0;
  NoiseShape noise = NoiseShape::kWhite;
  bool gaps = false;
  bool single_rows = false;
  std::optional<Excitation> excitation;
  bool twice = false;           ///< also Draft::again
  double again_length_s = 0.0;  ///< 0: as length_s
  double again_rate_hz = 0.0;   ///< 0: as rate_hz
  /// None: as `excitation`.  With one, the noise has the newtons of the first recording, as a load
  /// cell's has.
  std::optional<Excitation> again_excitation = {};
};

/// Measured channels: a_y first, f last.
struct Recording {
  std::vector<std::string> names;
  std::vector<std::string> units;
  std::vector<Series> columns;
  Series time_s;
  double rate_hz = 0.0;  ///< of the grid on which the rows lie
};

struct PlantedEffect {
  Kind kind{};
  std::string variant;
  std::vector<std::string> channels;
  std::vector<std::string> also;
  std::vector<Parameter> parameters;
  double strength = 0.0;  ///< alone: rms(f with - f without) / rms(f without), means left out
  double wanted_strength = 0.0;
  double left_by_order_4 = 0.0;  ///< alone: see Truth
  double evidence = 0.0;         ///< alone: see Truth
  /// of the parts of two contributions that no linear model of a_y explains: the largest
  /// correlation with another planted effect, 0 .. 1; near 1 the two cannot be distinguished
  double overlap = 0.0;
  double marginal = 0.0;  ///< rms(f with all - f with all but this) / rms(f without any)
};

/// The label; sealed until the verdict exists.
struct Truth {
  std::uint64_t seed = 0;
  std::vector<PlantedEffect> effects;  ///< strongest first, by marginal strength
  double strength = 0.0;               ///< of all together
  double irreducible = 0.0;  ///< rms that no 2 s impulse response explains / rms(f noise-free)
  /// rms that a difference equation of order 4, run free, leaves of the noise-free force / its rms;
  /// NaN when not computed (more than 100 000 samples)
  double left_by_order_4 = 0.0;
  /// samples (left_by_order_4 force_rms / noise_rms)^2: twice the log-likelihood that white noise
  /// of this size leaves between the effects and none; below some tens no method can detect them
  double evidence = 0.0;
  double force_rms_n = 0.0;  ///< noise-free, effects included, mean left out
  double noise_rms_n = 0.0;  ///< the noise floor: rms(f recorded - f noise-free)
  double snr_db = 0.0;
  std::string noise;
  std::string losses;
  Body body;
  BodyFigures figures;
  Excitation excitation;
  double length_s = 0.0;
  double rate_hz = 0.0;
};

struct Draft {
  Recording recording;
  Truth truth;
  /// Spec::twice: the same body and effects, with the same numbers, on another ride with other
  /// channels, noise and losses.
  std::optional<Recording> again;
};

/// The same seed and spec give the same recording to the last bit.
/// @throws std::invalid_argument when length, rate or a strength is not positive, or a kind comes
/// twice.
Draft draw(std::uint64_t seed, const Spec& spec);

}  // namespace stillhand::planted

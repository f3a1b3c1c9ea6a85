// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "tests/planted/body.hpp"
#include "tests/planted/effect.hpp"
#include "tests/planted/scene.hpp"

namespace stillhand::planted {

/// An effect with its size.
struct SizedEffect {
  Effect effect;
  double size = 0.0;
  double strength = 0.0;         ///< reached, alone
  double left_by_order_4 = 0.0;  ///< alone, see Truth
  double evidence = 0.0;         ///< alone, see Truth
};

/// rms(with - without) / rms(without), means left out.
double strength_of(const Series& with, const Series& without);

/// One body on one ride: simulates the force with any effects and finds sizes for strengths.
class Stand {
 public:
  static constexpr std::size_t kNoneLeftOut = SIZE_MAX;

  /// @param scene  must outlive the stand
  Stand(const Body& body, const Scene& scene);

  /// At the recording's samples.  @param but  index of an effect to leave out
  [[nodiscard]] Series force_n(const std::vector<SizedEffect>& effects,
                               std::size_t but = kNoneLeftOut,
                               const Series& early_noise_n = {}) const;
  /// Without any effect.
  [[nodiscard]] const Series& plain_n() const { return plain_n_; }

  /// Draws until an effect reaches the strength, to 1 %, and the evidence; else the nearest of
  /// twelve.
  [[nodiscard]] SizedEffect plant(Kind kind, double strength, double least_evidence, double snr_db,
                                  Draw& draw) const;
  /// Share of a force that no impulse response of 2 s from a_y explains, at about 100 Hz.
  [[nodiscard]] Series beyond_linear(const Series& force_n) const;
  /// See Truth; NaN for a recording shorter than 4 s.
  [[nodiscard]] double irreducible(const Series& force_n) const;
  [[nodiscard]] double left_by_order_4(const Series& force_n) const;

 private:
  [[nodiscard]] double strength_at(const Effect& effect, double size) const;
  [[nodiscard]] SizedEffect fit_size(Effect effect, double strength, Draw& draw) const;

  Body body_;
  const Scene& scene_;
  double rate_hz_ = 0.0;  ///< of the recording
  double stride_ = 1.0;   ///< samples, to come to about 100 Hz in the linear fits
  Reference reference_;
  Series a_y_;
  Series body_force_n_;
  Series plain_n_;
};

/// samples (left force_rms / noise_rms)^2, see Truth.
double evidence_of(double left, double snr_db, std::size_t samples);

}  // namespace stillhand::planted

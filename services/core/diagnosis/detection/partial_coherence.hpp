// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// Coherence of a residual with one channel.
struct ChannelCoherence {
  std::string channel;
  std::vector<double> coherence;  ///< [-] by CoherenceResult::frequency_hz
  double highest = 0.0;           ///< [-]
  double highest_hz = 0.0;
  double p = 1.0;            ///< [-] of that by chance, corrected for frequencies and channels
  bool significant = false;  ///< p below CoherenceResult::kSignificance
};

/// What of a residual goes together with other channels, line by line.
struct CoherenceResult {
  static constexpr double kSignificance = 0.01;

  std::vector<double> frequency_hz;        ///< without the two lowest lines: means and drifts
  std::vector<double> residual_density;    ///< [unit^2/Hz] one-sided, of samples that count
  double independent_averages = 0.0;       ///< n_d [-]; 0: too short a record, nothing was computed
  double partial_threshold = 1.0;          ///< [-] Eq. DG-46
  double ordinary_threshold = 1.0;         ///< [-] the same for the inputs
  std::vector<ChannelCoherence> partial;   ///< measured channels that are no input
  std::vector<ChannelCoherence> ordinary;  ///< the inputs
  /// [unit of the output] RMS of what isn't coherent with any input, freed of what chance makes
  /// coherent, Eq. DG-47; 0: not computed.
  double incoherent_rms = 0.0;
};

/// Partial coherence of a residual with each channel, the inputs taken out of both, Eq. DG-45, and
/// ordinary coherence with each input.  Welch's averages (Hann, half overlapping) over segments
/// within the stretches.  Shows that a linear path of any dynamics exists, and at which
/// frequencies; the page shows it, the verdict does not use it. Source: Bendat and Piersol, Random
/// Data, 4th ed., chapter 7 (conditioned spectra).  Pure.
/// @param residual  weighted, as long as the signals
CoherenceResult coherence_of(const Eigen::VectorXd& residual, const std::vector<double>& weight,
                             const Signals& signals);

}  // namespace stillhand::diagnosis

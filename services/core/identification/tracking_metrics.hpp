// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <vector>

#include "services/core/signal/reference.hpp"

namespace stillhand::identification {

/// The measured ticks of a tracking trial, nothing before or after.
struct TrackingRecord {
  double rate_hz = 0.0;          ///< [Hz]
  std::vector<double> target_m;  ///< x_r [m] on the screen, + right
  std::vector<double> cursor_m;  ///< x_p [m]
};

/// Open loop at one line of the reference.
struct OpenLoopLine {
  std::int64_t harmonic;      ///< h [cycles a trial]
  double frequency_hz;        ///< [Hz]
  std::complex<double> gain;  ///< G = X_p / X_e, Eq. ID-14 [-]
  double cursor_snr;          ///< |X_p|^2 over the remnant's power around the line [-]
  double error_snr;           ///< |X_e|^2 over the same [-]
};

/// Paper III-C, METHOD Eq. ID-12 to ID-17.
struct TrackingMetrics {
  double rms_error_mm = 0.0;            ///< Eq. ID-12 [mm]
  double dwell_ratio = 0.0;             ///< Eq. ID-13 [-], |x_e| < half width
  double crossover_hz = 0.0;            ///< Eq. ID-16 [Hz], the paper's line fit; NaN: no fit
  double crossover_reference_hz = 0.0;  ///< Eq. ID-15 [Hz], remnant taken off; NaN: all remnant
  std::array<OpenLoopLine, signal::kReferenceLines> lines{};
  std::vector<double> moving_rms_mm;  ///< Eq. ID-17 [mm]; entry i covers samples i .. i + W - 1
  std::vector<double> moving_dwell;   ///< [-]; both empty for a trial shorter than the window
};

/// Metrics of one trial.  The record must hold whole cycles of the design's harmonics, as a trial's
/// measured ticks do.  On such a record X_p / X_e and the estimate through the reference,
/// S(x_r,x_p) / S(x_r,x_e), are one and the same number at a line; the bias that the remnant leaves
/// in it is of the logarithm, where signal and remnant are of one size.  crossover_reference_hz
/// avoids it: the remnant's power, read from the unexcited harmonics around each line, is taken off
/// and the lines are pooled before a ratio is formed.  METHOD "Crossover" compares them.  Pure.
/// @throws stillhand::ConfigError for unequal or short records, a sample that isn't finite, or a
/// harmonic beyond half the rate.
TrackingMetrics tracking_metrics(const TrackingRecord& record,
                                 const signal::ReferenceDesign& design);

}  // namespace stillhand::identification

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "diagnosis/core/screening.hpp"

namespace stillhand::diagnosis {

/// One question that was put to a residual.
struct Detection {
  std::string question;  ///< for example "linear in", "square of", "gain over time"
  std::string channel;   ///< what it was asked about; may be empty
  double share = 0.0;    ///< [-] of the squared error that it explains, held out
  double p = 1.0;        ///< [-] Holm's correction for all questions applied
  bool found = false;    ///< share and p say that something is there
};

/// Autocorrelation of a residual.
struct Whiteness {
  std::vector<double> autocorrelation;  ///< [-] lags 0 to 1 s
  double bound = 0.0;                   ///< [-] 99 % of a white residual's lie within +-bound
  double share_outside = 0.0;           ///< [-] of the lags
};

/// Spread of a residual over the record.
struct Spread {
  std::vector<double> time_s;  ///< [s] middle of each block
  std::vector<double> rms;     ///< [unit of the output]
  double largest_ratio = 1.0;  ///< [-] largest over median
};

/// What the residual of a model still depends on, README "Detection".
struct DetectionResult {
  std::vector<Detection> detections;  ///< strongest first
  Whiteness whiteness;                ///< colour alone is no effect
  Spread spread;                      ///< nor is uneven noise
};

/// Puts every question to a residual: each signal at several lags, powers and products of signals
/// and of the body's output, its past and sign, gains and offsets over time.  Each is judged on
/// held-out blocks beside the model, whose numbers may move; p after Holm.
DetectionResult detected(const Screening& screening);

}  // namespace stillhand::diagnosis

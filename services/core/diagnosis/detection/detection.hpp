// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "services/core/diagnosis/detection/detection_lines.hpp"
#include "services/core/diagnosis/detection/partial_coherence.hpp"
#include "services/core/diagnosis/detection/surrogates.hpp"
#include "services/core/diagnosis/fitting/screening.hpp"

namespace stillhand::diagnosis {

/// A question is answered yes above this share [-] of the squared error (3 % of its root: less is
/// not worth a question),
inline constexpr double kLeastShare = 0.06;
/// and up to this probability [-] by chance: of all questions together by surrogates, Eq. DG-93, of
/// the lines after Holm.
inline constexpr double kSignificance = kSurrogateSignificance;
/// Question about a multisine's detection lines; its `channel` says which lines.
inline constexpr const char* kDistortion = "distortion at";

/// One question that was put to a residual.
struct Detection {
  std::string question;  ///< for example "linear in", "square of", "gain over time"
  std::string channel;   ///< what it was asked about; may be empty
  double share = 0.0;    ///< [-] of the squared error that it explains, held out
  double p = 1.0;        ///< [-] of such a share in any answer by chance: of the surrogates, or, of
                         ///< lines, after Holm
  bool found = false;    ///< share and p say that something is there
  std::vector<std::string> channels = {};  ///< the measured ones among what it was asked about
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

/// What the residual of a model still depends on, METHOD "Detection".
struct DetectionResult {
  std::vector<Detection> detections;    ///< strongest first
  Whiteness whiteness;                  ///< colour alone is no effect
  Spread spread;                        ///< nor is uneven noise
  CoherenceResult coherence;            ///< with every measured channel; shown, not judged
  std::optional<DetectionLines> lines;  ///< where the excitation is periodic
};

/// Puts every question to a residual: each signal at several lags, powers and products of signals
/// and of the body's output, its past and sign, gains and offsets over time.  Each is judged on
/// held-out blocks next to the model, whose numbers are fitted again, and asked of surrogates of
/// the residual as well (Eq. DG-93).  Where the input is periodic, the lines that it does not
/// excite are tested too (Eq. DG-44).
/// @param excitation  of the same signals
DetectionResult detected(const Screening& screening,
                         const std::optional<PeriodicExcitation>& excitation);

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/carried.hpp"
#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::predict {

/// Fewer rows are not scored: of so many independent errors an RMSE is known to 1/sqrt(2 * 20),
/// 16 %, and those of a free run are not independent.
inline constexpr std::size_t kLeastScored = 20;

/// A free run over a recording that need not hold the output.
struct Prediction {
  recording::Recording table;      ///< `t [s]`, `<output>_model [unit]`, a row a measured sample
  std::string output;              ///< the channel that is predicted
  std::vector<std::string> notes;  ///< effects left out, ranges left: one clause each
  std::vector<diagnosis::SampleFault> screening = {};
  std::vector<bool> given = {};  ///< [rows] those that gave the start; no score counts them
};

/// From the inputs alone; every stretch from the steady state of its first second (DG-54), every
/// effect held at the edges of the range in which it was seen (DG-56).  Of a model without ranges,
/// effects that the inputs do not determine (a tone, a drift, a burst) are left out, and a changing
/// gain is taken at 1.
/// @param start_samples  rows at the start of each stretch whose measured output gives the body's
///                       state there, Eq. DG-82; 0: from the inputs alone
/// @throws stillhand::ConfigError when a channel is missing, the rate is neither the model's nor a
///         whole multiple of it, or the start needs an output that is not there, or leaves fewer
///         than kLeastScored rows to predict.
Prediction predict(const diagnosis::CarriedModel& carried,
                   const diagnosis::Measurement& measurement, std::size_t start_samples = 0);

}  // namespace stillhand::predict

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/carried.hpp"
#include "services/core/diagnosis/measurement.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::predict {

/// A free run over a recording that need not hold the output.
struct Prediction {
  recording::Recording table;      ///< `t [s]`, `<output>_model [unit]`, a row a measured sample
  std::string output;              ///< the channel that is predicted
  std::vector<std::string> notes;  ///< effects left out, ranges left: one clause each
  std::vector<diagnosis::SampleFault> screening = {};
};

/// From the inputs alone; every stretch from the steady state of its first second (DG-54), every
/// effect held at the edges of the range in which it was seen (DG-56).  Of a model without ranges,
/// effects that the inputs do not determine (a tone, a drift, a burst) are left out, and a changing
/// gain is taken at 1.
/// @throws stillhand::ConfigError when a channel is missing, or the rate is neither the model's nor
///         a whole multiple of it.
Prediction predict(const diagnosis::CarriedModel& carried,
                   const diagnosis::Measurement& measurement);

}  // namespace stillhand::predict

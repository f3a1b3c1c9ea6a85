// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/diagnosis/core/measurement.hpp"
#include "services/diagnosis/core/model/model.hpp"
#include "services/recording/core/recording.hpp"

namespace stillhand::predict {

/// A free run over a recording that need not hold the output.
struct Prediction {
  recording::Recording table;      ///< `t [s]`, `<output>_model [unit]`, a row a measured sample
  std::vector<std::string> notes;  ///< one clause for each effect that was left out
};

/// From rest at the start of every stretch, from the inputs alone: effects that the inputs do not
/// determine (a tone, a drift, a burst) are left out, a changing gain is taken at its mean.
/// @throws stillhand::ConfigError when a channel is missing, or the rate is neither the model's nor
/// a
///         whole multiple of it.
Prediction predict(const diagnosis::Model& model, const diagnosis::Measurement& measurement);

}  // namespace stillhand::predict

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/model/effect.hpp"
#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// A kind that makes its examples itself; those of the others are made in effects/examples.cpp.
class MakesExamples {
 public:
  virtual ~MakesExamples() = default;
  /// As this recording could have it, one of every channel that it may read.
  [[nodiscard]] virtual std::vector<Effect> examples(const Model& model,
                                                     const Signals& signals) const = 0;
};

/// Each kind as this recording could have it, next
/// to a model: one of every channel that it may read, with middling numbers (thresholds of about a
/// standard deviation).  Its size is not meant: Eq. DG-62 takes what it adds to the prediction
/// times a factor.  A kind that the channels do not allow is not among them.
std::vector<Effect> examples(const Model& model, const Signals& signals);

}  // namespace stillhand::diagnosis

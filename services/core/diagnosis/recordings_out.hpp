// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/model/model.hpp"

namespace stillhand::diagnosis {

/// Errors of an effect's model on each of the recordings that were joined, held out whole, METHOD
/// Eq. DG-52.  Pure.
class RecordingsOut {
 public:
  RecordingsOut(const Signals& signals, const Blocks& blocks);

  /// More than one was joined.
  [[nodiscard]] bool several() const noexcept { return blocks_.folds > 1; }
  /// [unit of the output] RMS error of each recording, by a fit to the others.
  [[nodiscard]] std::vector<double> errors(const Model& model) const;

 private:
  const Signals& signals_;
  Blocks blocks_;
};

/// [-] by which each error falls: 1 - after / before.
std::vector<double> falls(const std::vector<double>& before, const std::vector<double>& after);
/// True when an effect helps one recording at most and harms another.
/// @param fall   of every recording's error, held out
/// @param least  [-] that counts as help or as harm
bool refuted(const std::vector<double>& fall, double least);

}  // namespace stillhand::diagnosis

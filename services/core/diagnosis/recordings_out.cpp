// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/recordings_out.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/diagnosis/fitting/held_out.hpp"

namespace stillhand::diagnosis {

RecordingsOut::RecordingsOut(const Signals& signals, const Blocks& blocks)
    : signals_(signals), blocks_(by_recording(blocks, signals)) {}

std::vector<double> RecordingsOut::errors(const Model& model) const {
  const HeldOut held = held_out(model, signals_, blocks_);
  std::vector<double> squares(blocks_.folds, 0.0);
  std::vector<double> weights(blocks_.folds, 0.0);
  for (std::size_t b = 0; b < blocks_.count; ++b) {
    squares[blocks_.fold_of(b)] += held.squares[b];
    weights[blocks_.fold_of(b)] += held.weights[b];
  }
  std::vector<double> errors;
  for (std::size_t r = 0; r < squares.size(); ++r) {
    errors.push_back(std::sqrt(squares[r] / std::max(weights[r], 1.0)));
  }
  return errors;
}

std::vector<double> falls(const std::vector<double>& before, const std::vector<double>& after) {
  std::vector<double> fall;
  for (std::size_t r = 0; r < before.size(); ++r) {
    fall.push_back(1.0 - after[r] / std::max(before[r], 1e-300));
  }
  return fall;
}

bool refuted(const std::vector<double>& fall, double least) {
  const auto helped = std::ranges::count_if(fall, [least](double f) { return f > least; });
  // Written so that a model that ran away on one harms it.
  const bool harmed = !std::ranges::all_of(fall, [least](double f) { return f >= -least; });
  return helped <= 1 && harmed;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "apps/diagnose/page/evidence.hpp"

namespace stillhand::diagnose {

/// One number of a model with its unit, for people.
struct ModelNumber {
  std::string name;
  double value = 0.0;
  double standard_error = 0.0;  ///< NaN: not fitted, or not determined by the record
  std::string unit;
  std::string origin;  ///< "fitted", "searched", "given"
};

/// Place of an effect's first fitted number in packed().
std::size_t first_number(const diagnosis::Model& model, std::size_t which);

/// Coefficients of the terms, then the parameters.  Coefficients of a path through the body or of a
/// loop are left out: a single one has no meaning.
/// @param which  index in found.model.effects
std::vector<ModelNumber> effect_numbers(const Evidence& evidence, std::size_t which);

/// Of the linear part of the final model: static: offset and a factor for each input; otherwise
/// offset, gain at 0 Hz for each input, and the poles as frequency and damping ratio.
std::vector<ModelNumber> body_numbers(const Evidence& evidence);

}  // namespace stillhand::diagnose

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
  double standard_error = 0.0;  ///< NaN: not fitted, or the record does not determine it
  std::string unit;
  std::string origin;  ///< "derived", "fitted", "searched", "given"
};

/// The sizes of an effect of the verdict.  @param which  index in found.effects
std::vector<ModelNumber> effect_numbers(const Evidence& evidence, std::size_t which);

/// Of the linear part of the final model: static: offset and a factor for each input; otherwise
/// offset, gain at 0 Hz for each input, and the poles as frequency and damping ratio.
std::vector<ModelNumber> body_numbers(const Evidence& evidence);

}  // namespace stillhand::diagnose

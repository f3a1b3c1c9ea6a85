// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "services/core/cancellation/control_model.hpp"
#include "services/core/cancellation/model_check.hpp"

namespace stillhand::cancellation {

/// Least and greatest slope of a map, [unit of the result a unit of the argument].
struct Slopes {
  double least;
  double most;
  [[nodiscard]] double steepest() const { return std::max(std::abs(least), std::abs(most)); }
};
/// @param map  finite, with two values or more; without values the identity
Slopes slopes_of(const ValueMap& map);

/// The same behind an element with memory; null: without one.
Slopes slopes_of(const ValueMap& map, const Hysteresis* memory);

/// The gains of METHOD Eq. CC-14 against their bounds.  Paths of one channel add up, and so do
/// waves: a force that one of them may not ask for is refused from all of them together, too. Pure.
/// @param model  well formed and stable
/// @param poles  of its denominator
Refusal check_strength(const ControlModel& model, const std::vector<std::complex<double>>& poles,
                       const ModelBounds& bounds);

}  // namespace stillhand::cancellation

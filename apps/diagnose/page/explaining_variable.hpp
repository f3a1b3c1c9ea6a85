// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/diagnose/page/evidence.hpp"

namespace stillhand::diagnose {

/// A quantity that an effect may be a function of.
struct Variable {
  std::string name;  ///< with its unit, as on an axis
  std::vector<double> values;
  bool by_direction = false;  ///< the effect is another function where the quantity falls
  double share = 0.0;         ///< [-] of the effect's variance that it explains
};

/// The variable of which the effect is most nearly a function: one of the effect's channels, now or
/// up to half a second ago, their product, a period, the model's output, or time.  Of several that
/// are as good the first; none when there is no candidate.
std::optional<Variable> explaining_variable(const Evidence& evidence,
                                            const diagnosis::Effect& effect,
                                            const EffectTrace& trace);

}  // namespace stillhand::diagnose

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "apps/diagnose/page/evidence.hpp"

namespace stillhand::diagnose {

/// A quantity that an effect may be a function of.
struct Variable {
  std::string name;  ///< with its unit, as an axis says it
  std::vector<double> values;
  bool by_direction = false;  ///< the effect is another function where the quantity falls
  double share = 0.0;         ///< [-] of the effect's variance that it explains
};

/// Of the effect's channels, now and up to half a second ago, their product, its period, the
/// model's output and time: the one of which the effect is most nearly a function.  The first of
/// those that are as good; none when there is none to ask.
std::optional<Variable> explaining_variable(const Evidence& evidence,
                                            const diagnosis::Effect& effect,
                                            const EffectTrace& trace);

}  // namespace stillhand::diagnose

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "apps/diagnose/page/figures.hpp"
#include "services/core/diagnosis/model/size.hpp"

/// Parts of law_of().
namespace stillhand::diagnose {

inline constexpr std::size_t kLawPoints = 120;
inline constexpr std::size_t kLawBins = 24;

/// A line with its band of 95 %, behind what the panel has.
/// @param error  standard errors
void add_with_band(const std::string& label, const std::vector<double>& x,
                   const std::vector<double>& y, const std::vector<double>& error,
                   report::Panel& panel);

/// Magnitude and phase of a path over the band of what drives it; none where there is none.
Law path_law(const Evidence& evidence, const diagnosis::SizeCase& at, const EffectTrace& trace);
/// A map's output over its input, from end to end of what was seen.
Law map_law(const Evidence& evidence, const diagnosis::SizeCase& at, const EffectTrace& trace);

}  // namespace stillhand::diagnose

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "services/core/diagnosis/fitting/screening.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"

/// Nonlinearities inside the body, Eq. DG-4: proposals.
namespace stillhand::diagnosis {

/// phi of a signal in units of its threshold, with memory.
using Shape = std::function<double(double z, LoopMemory& memory)>;

/// A nonlinearity inside the body, tried at the output and at the displacement of every mode, with
/// thresholds of 0.5 to 3 standard deviations.
/// @param form  begins the effect's form; " of the output" or " inside the body" is added
/// @param homogeneous  phi(c z) is a multiple of phi(z): there is no threshold to find
std::vector<Proposal> loop_proposals(const Screening& screening, const std::string& kind,
                                     const std::string& form, const Shape& shape, bool homogeneous);

/// Threshold of a feedback effect; 1 inside the body, where the path holds the scale.
double threshold_of(const Effect& effect);

}  // namespace stillhand::diagnosis

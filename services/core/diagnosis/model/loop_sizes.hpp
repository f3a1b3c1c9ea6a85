// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/diagnosis/model/size.hpp"

/// Physical numbers of a nonlinearity inside the body, METHOD Eq. DG-73 to DG-75.  Pure.
namespace stillhand::diagnosis {

/// z of the largest motion that was seen, in thresholds.
double largest_argument(const SizeCase& at);

/// [output unit] for z = 1 threshold, of small motions; inside the body at centre_hz, and negative
/// where z goes against the output.  Eq. DG-74.
double output_over_argument(const SizeCase& at);

/// [output unit] that phi = 1 adds to the output at 0 Hz.  Eq. DG-75.
double output_over_phi(const SizeCase& at);

/// Eq. DG-73: the body's stiffness at the nonlinearity's place where phi has the slope `there`,
/// over that where it has the slope `here`.  Below 1: softer.
Size stiffness_ratio(const SizeCase& at, double there, double here, const std::string& meaning);

/// Eq. DG-74: amplitude of the output at which z reaches `thresholds` thresholds.
Size force_at_threshold(const SizeCase& at, const std::string& name, double thresholds,
                        const std::string& meaning);

}  // namespace stillhand::diagnosis

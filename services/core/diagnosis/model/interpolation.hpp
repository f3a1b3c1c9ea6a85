// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "services/core/diagnosis/model/signals.hpp"

namespace stillhand::diagnosis {

/// x(t - delay(t)), Eq. DG-2, by Lagrange's polynomial through the six nearest samples; error about
/// 0.31 sin^6(pi f / rate) of the amplitude: 1e-3 at an eighth of the sample rate.  Before a
/// stretch's first and after its last sample the signal is held. Source: Laakso et al., IEEE Signal
/// Processing Magazine 13(1), 1996.
/// @param delay_s  of a time [s] since the measurement's start; negative: ahead
std::vector<double> delayed(const std::vector<double>& x, const Signals& signals,
                            const std::function<double(double)>& delay_s);

/// The same polynomial at a place between the samples of one run, held beyond its ends.
/// @param place  [samples] from the first
double value_at(std::span<const double> x, double place);

}  // namespace stillhand::diagnosis

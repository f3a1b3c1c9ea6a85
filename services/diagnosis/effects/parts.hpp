// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "diagnosis/core/effect_kind.hpp"
#include "diagnosis/core/screening.hpp"

/// What several kinds propose alike.
namespace stillhand::diagnosis {

/// phi of a signal in units of its threshold, with memory.
using Shape = std::function<double(double z, LoopMemory& memory)>;

/// The better ones of some proposals, best first.
std::vector<Proposal> best_of(std::vector<Proposal> proposals, std::size_t count);

/// A nonlinearity inside the body: where it would have to sit, tried at the output and at every
/// mode's own displacement, with thresholds of 0.5 to 3 standard deviations.
/// @param form  begins the effect's form; " of the output" or " inside the body" is added
/// @param homogeneous  phi(c z) is a multiple of phi(z): no threshold to be found
std::vector<Proposal> loop_proposals(const Screening& screening, const std::string& kind,
                                     const std::string& form, const Shape& shape, bool homogeneous);

/// z in units of the effect's threshold; inside the body the scale is in the path.
double in_thresholds(const Effect& effect, double z);

/// A map of the first input that differs from the identity: what the difference brings at the
/// body's output, for parameter values to try.
std::vector<Proposal> input_map_proposals(
    const Screening& screening, const Effect& effect, const std::vector<double>& values,
    const std::function<double(double u, double value)>& difference);

/// The same for a map of the output.
std::vector<Proposal> output_map_proposals(
    const Screening& screening, const Effect& effect, const std::vector<double>& values,
    const std::function<double(double y, double value)>& difference);

/// The response of the body to a signal in place of its first input.
std::vector<double> response_of(const Screening& screening, const std::vector<double>& input);

/// Standard deviation about the mean.
double deviation_of(const std::vector<double>& values);

/// Number and unit, for evidence: "3.2 N".
std::string with_unit(double value, const std::string& unit);

/// Elastic and perfectly plastic element with limit 1 ("stop" operator): hysteresis and, as
/// z - stop(z), play.  Source: Visintin, Differential Models of Hysteresis, 1994.
double stop_operator(double z, LoopMemory& memory);
/// Dahl's (1968) smooth relative: dw = dz (1 - w sign(dz)).
double dahl_operator(double z, LoopMemory& memory);

}  // namespace stillhand::diagnosis

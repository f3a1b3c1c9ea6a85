// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "services/diagnosis/core/fitting/screening.hpp"
#include "services/diagnosis/core/model/effect_kind.hpp"

/// Proposals that several kinds share.
namespace stillhand::diagnosis {

/// phi of a signal in units of its threshold, with memory.
using Shape = std::function<double(double z, LoopMemory& memory)>;

/// The better ones of some proposals, best first.
std::vector<Proposal> best_of(std::vector<Proposal> proposals, std::size_t count);

/// A nonlinearity inside the body, tried at the output and at the displacement of every mode, with
/// thresholds of 0.5 to 3 standard deviations.
/// @param form  begins the effect's form; " of the output" or " inside the body" is added
/// @param homogeneous  phi(c z) is a multiple of phi(z): there is no threshold to find
std::vector<Proposal> loop_proposals(const Screening& screening, const std::string& kind,
                                     const std::string& form, const Shape& shape, bool homogeneous);

/// Threshold of a feedback effect; 1 inside the body, where the path holds the scale.
double threshold_of(const Effect& effect);

/// A map of the first input: for each parameter value to try, the gain that its difference from the
/// identity brings at the body's output; and the best of them with a body of its own.
std::vector<Proposal> input_map_proposals(
    const Screening& screening, const Effect& effect, const std::vector<double>& values,
    const std::function<double(double u, double value)>& difference);

/// The same for a map of the output.  @param before  the map's inverse, as far as there is one
std::vector<Proposal> output_map_proposals(
    const Screening& screening, const Effect& effect, const std::vector<double>& values,
    const std::function<double(double y, double value)>& difference,
    const std::function<double(double y, double value)>& before);

/// The inputs as measured, [inputs][samples].
std::vector<std::vector<double>> measured_inputs(const Screening& screening);

/// A body of the model's order, estimated again from the inputs and the output as an effect maps
/// them.
Body body_anew(const Screening& screening, const std::vector<std::vector<double>>& inputs,
               const std::vector<double>& output);

/// The proposal whose free run with a body of its own leaves least.  The body that was fitted
/// without the effect may be in a local minimum that no step with the effect leaves.
/// @return without a body where none is finite, the body is static or the model has other effects
Proposal best_with_body(const Screening& screening, std::vector<Proposal> proposals,
                        const std::function<Body(const Effect&)>& body_for);

/// The response of the body to a signal in place of its first input.
std::vector<double> response_of(const Screening& screening, const std::vector<double>& input);

/// Standard deviation about the mean.
double deviation_of(const std::vector<double>& values);

/// The value below which a share of the values lies.
double quantile_of(std::vector<double> values, double share);

/// Number and unit, for evidence: "3.2 N".
std::string with_unit(double value, const std::string& unit);

/// Elastic and perfectly plastic element with limit 1 ("stop" operator): hysteresis and, as
/// z - stop(z), play.  Source: Visintin, Differential Models of Hysteresis, 1994.
double stop_operator(double z, LoopMemory& memory);
/// Dahl's (1968) smooth relative: dw = dz (1 - w sign(dz)).
double dahl_operator(double z, LoopMemory& memory);

}  // namespace stillhand::diagnosis

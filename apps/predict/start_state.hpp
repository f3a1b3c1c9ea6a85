// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/signals.hpp"

/// The state that a body has at the start of a stretch, from the first samples of its output. Pure.
///
/// The state of A y_b = B u is p numbers e_1 .. e_p that act on the output at the stretch's first p
/// samples, Eq. DG-82:
///
///   A y_b = B u + e,   e_i(n) = sum_{k=i..p} (b_k u(n-k+i) - a_k y_b(n-k+i)), one sample before
///
/// so they have the output's unit.
namespace stillhand::predict {

/// [p x stretches], [unit of the output]
using StartStates = Eigen::MatrixXd;
/// The prediction at every row for these states.
using Answer = std::function<std::vector<double>(const StartStates& states)>;

/// Second moment of the state about the level of its first value, over a run, [p x p]: how far a
/// state strays that the inputs make.
/// @param inputs  [inputs][samples] as the body sees them
/// @param output  [samples] y_b
Eigen::MatrixXd state_spread(const diagnosis::Body& body,
                             const std::vector<std::vector<double>>& inputs,
                             const std::vector<double>& output,
                             const std::vector<diagnosis::Stretch>& stretches);

/// The states that are most likely for the first rows of each stretch, by Gauss and Newton: the
/// residual is white, and the state has the spread S times 1, 3, 10 or 30, with which the rows are
/// most likely.
/// @param measured  [rows] of the output
/// @param rows      [stretches] those that are known
/// @param spread    S, [p x p]
/// @param noise     RMS of the residual, above 0, [unit of the output]
StartStates most_likely_start(const std::vector<double>& measured,
                              const std::vector<std::vector<std::size_t>>& rows,
                              const Eigen::MatrixXd& spread, double noise, const Answer& answer);

}  // namespace stillhand::predict

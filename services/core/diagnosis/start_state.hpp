// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <functional>
#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

/// The state that a model has at the start of a stretch, from the first samples of its output.
///
/// The state of A y_b = B u is p numbers e_1 .. e_p that act on the output at the stretch's first p
/// samples, Eq. DG-82:
///
///   A y_b = B u + e,   e_i(n) = sum_{k=i..p} (b_k u(n-k+i) - a_k y_b(n-k+i)), one sample before
///
/// so they have the output's unit.  An effect with poles of its own has such numbers too.
namespace stillhand::diagnosis {

/// [stretches] the first samples there, of which the output is known
using GivenRows = std::vector<std::vector<std::size_t>>;
/// What a model predicts over the signals, at every sample of `measured`.
using Answer = std::function<std::vector<double>(const Signals& signals)>;

/// Second moment of the state about the level of its first value, over a run, [p x p]: how far a
/// state strays that the inputs make.
/// @param inputs  [inputs][samples] as the body sees them
/// @param output  [samples] y_b
Eigen::MatrixXd state_spread(const Body& body, const std::vector<std::vector<double>>& inputs,
                             const std::vector<double>& output,
                             const std::vector<Stretch>& stretches);

/// The numbers of a model's state: the body's poles and those that its effects add.
std::size_t state_size(const Model& model);

/// How far its states stray in a run over the signals, in blocks.
Eigen::MatrixXd spread_of(const Model& model, const Signals& signals);

/// The states, [numbers x stretches], that are most likely for the first rows of each stretch, by
/// Gauss and Newton: the residual is white, and the state has the spread of a run times 1, 3, 10 or
/// 30, with which the rows are most likely.
/// @param signals   the rows at least
/// @param measured  the output
/// @param noise     RMS of the residual, above 0, [unit of the output]
/// Pure.  @throws what `answer` does
Eigen::MatrixXd most_likely_start(const Model& model, const Signals& signals,
                                  const Eigen::MatrixXd& spread,
                                  const std::vector<double>& measured, const GivenRows& rows,
                                  double noise, const Answer& answer);

/// The same signals, each stretch from its state, [numbers x stretches].
Signals started(const Model& model, const Signals& signals, const Eigen::MatrixXd& states);

}  // namespace stillhand::diagnosis

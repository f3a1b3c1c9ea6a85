// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "services/core/diagnosis/fitting/blocks.hpp"
#include "services/core/diagnosis/fitting/impulse_response.hpp"
#include "services/core/diagnosis/model/model.hpp"

namespace stillhand::diagnosis {

/// Largest order of a difference model.
constexpr int kLargestOrder = 12;

/// The linear model and how it was reached.
struct Baseline {
  Model model;
  int order = 0;                       ///< p as asked for; the model's may be lower
  double equation_error_rmse = 0.0;    ///< free-run error of the least-squares start
  double rmse = 0.0;                   ///< free-run error after the refinement, all samples
  double impulse_response_rmse = 0.0;  ///< the bound above; NaN: no stretch is long enough
};

/// Output-error fit of a difference model of order p in all inputs with a common denominator,
/// Eqs DG-1 and DG-9, from several starts: the paper's least squares, the least squares of the
/// impulse response's prediction (noise taken out), both iterated after Steiglitz and McBride
/// (1965), and, where the impulse response leaves less, each of its modes with a second one tried
/// over the whole band. Where the input determines fewer poles than p, the order is reduced: the
/// others would be pole-zero pairs outside its band, whose held-out error has no meaning.
/// @param order  p; 0: static, linear in the inputs
/// @throws stillhand::ConfigError for an order outside 0 to 12 or a record too short for it.
Baseline fit_baseline(const Signals& signals, const Blocks& blocks, int order);

/// The body of the best of the starts for these inputs and this output, unrefined.
Body started_body(const std::vector<std::vector<double>>& inputs, const std::vector<double>& output,
                  const ImpulseResponse& impulse_response, const Signals& signals, int order);
/// From a body near by: iterated after Steiglitz and McBride.
Body refined_body(const Body& start, const std::vector<std::vector<double>>& inputs,
                  const std::vector<double>& output, const Signals& signals);
/// The poles `kept` and one mode more, the best of a grid of frequencies and dampings over the
/// whole band; numerators and offset fitted, all else as in `like`.
Body with_mode(const Body& like, const std::vector<double>& kept,
               const std::vector<std::vector<double>>& inputs, const std::vector<double>& output,
               const Signals& signals);
/// A fit may end in a local minimum where one mode is right and the other is not: each mode of a
/// fourth-order body is kept in turn, the other tried on a grid of frequency and damping.
/// @return the best of them, `fitted` included, unrefined
Body with_other_mode(const Body& fitted, const std::vector<std::vector<double>>& inputs,
                     const std::vector<double>& output, const Signals& signals);

}  // namespace stillhand::diagnosis

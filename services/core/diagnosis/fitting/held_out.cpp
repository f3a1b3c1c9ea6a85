// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/held_out.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/core/signal/decompositions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::diagnosis {
namespace {

// A fold may pull numbers that the data hardly determines far away, where the linearisation is
// void: relative to the diagonal.
constexpr double kDeviationRidge = 1e-6;

}  // namespace

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double HeldOut::rmse() const { return std::sqrt(sum_of(squares) / std::max(sum_of(weights), 1.0)); }

Eigen::MatrixXd held_out_steps(const Eigen::MatrixXd& training,
                               const Eigen::MatrixXd& with_residuals) {
  const Eigen::VectorXd scale = training.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd normal = scale.asDiagonal() * training * scale.asDiagonal();
  normal.diagonal().array() += kDeviationRidge;
  return scale.asDiagonal() *
         signal::solve_symmetric_columns(normal, scale.asDiagonal() * with_residuals);
}

HeldOut held_out_linearised(const Grams& grams, const Blocks& blocks) {
  HeldOut result;
  result.finite = true;
  result.weights = grams.weights;
  result.squares.resize(grams.blocks.size());
  const Eigen::Index count = grams.blocks.front().rows() - 1;
  for (std::size_t fold = 0; fold < blocks.folds; ++fold) {
    const Eigen::MatrixXd training = grams.total(blocks, static_cast<int>(fold));
    const Eigen::VectorXd step =
        held_out_steps(training.topLeftCorner(count, count), training.col(count).head(count));
    for (std::size_t b = 0; b < grams.blocks.size(); ++b) {
      if (blocks.fold_of(b) != fold) continue;
      const Eigen::MatrixXd& gram = grams.blocks[b];
      const double square = gram(count, count) - 2.0 * step.dot(gram.col(count).head(count)) +
                            step.dot(gram.topLeftCorner(count, count) * step);
      result.squares[b] = std::max(square, 0.0);
      result.finite = result.finite && std::abs(square) <= statistics::kLargestMagnitude;
    }
  }
  return result;
}

HeldOut held_out(const Model& model, const Signals& signals, const Blocks& blocks) {
  // Every fold's fit starts at the same numbers, as they are packed.
  Model packed_model = model;
  unpack(packed(model), packed_model);
  const Linearisation start = linearised(packed_model, signals);
  if (!start.finite) return held_out(model, signals, blocks, nullptr);
  const Grams grams = grams_of(start.jacobian, start.residual, start.run.weight, blocks);
  return held_out(model, signals, blocks, &grams);
}

HeldOut held_out(const Model& model, const Signals& signals, const Blocks& blocks,
                 const Grams* grams) {
  constexpr int kRefitIterations = 3;
  HeldOut result;
  result.finite = true;
  result.squares.assign(blocks.count, 0.0);
  result.weights.assign(blocks.count, 0.0);
  for (std::size_t fold = 0; fold < blocks.folds; ++fold) {
    Model refitted = model;
    FitOptions options;
    options.max_iterations = kRefitIterations;
    options.without_fold = static_cast<int>(fold);
    options.at_start = grams;
    const FitResult fitted = fit(refitted, signals, blocks, options);
    result.finite = result.finite && fitted.finite;
    for (std::size_t n = 0; n < signals.size(); ++n) {
      const std::size_t block = n / blocks.length;
      if (blocks.fold_of(block) != fold) continue;
      const double r = fitted.residual[static_cast<Eigen::Index>(n)];
      result.squares[block] += r * r;
      result.weights[block] += fitted.run.weight[n];
    }
  }
  result.finite = result.finite && sum_of(result.squares) <= statistics::kLargestMagnitude;
  return result;
}

}  // namespace stillhand::diagnosis

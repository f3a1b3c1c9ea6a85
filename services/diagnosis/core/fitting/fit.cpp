// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/fitting/fit.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/contract/config_error.hpp"
#include "services/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kBlocks = 30;
constexpr std::size_t kFolds = 5;
constexpr double kShortestBlock_s = 2.0;
constexpr std::size_t kFewestBlocks = 10;
constexpr std::size_t kFewestWeighing = 8;  // the first may lie in what isn't judged
constexpr std::size_t kFewestSamples = 5;
// Keeps a direction that the data doesn't determine from blowing up; relative to the diagonal.
constexpr double kRidge = 1e-11;
// A fold may pull numbers that the data hardly determines far away, where the linearisation is
// void: relative to the diagonal.
constexpr double kDeviationRidge = 1e-6;

double squared_error(const Eigen::MatrixXd& gram) { return gram(gram.rows() - 1, gram.cols() - 1); }

// The problem as ceres::TinySolver wants it: [J r] compressed to the Cholesky factor of its Gram
// matrix, which has the same J^T J, J^T r and |r|.
class Compressed {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Compressed(Model& model, const Signals& signals, const Blocks& blocks, int without_fold)
      : model_(model), signals_(signals), blocks_(blocks), without_fold_(without_fold) {
    start_ = packed(model);
    Eigen::MatrixXd gram = gram_at(start_);
    if (const double step = offset_step(gram); step != 0.0) {
      start_[0] += step;
      gram = gram_at(start_);
    }
    scale_ = gram.diagonal().head(start_.size()).cwiseSqrt();
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      if (!(scale_[i] > 0.0)) scale_[i] = 1.0;
    }
    unit_ = std::sqrt(std::max(squared_error(gram), 1e-300));
    first_ = gram;
  }

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(start_.size()) + 1; }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(start_.size()); }

  // x: numbers by scale_, about the start, in units of the starting error.
  bool operator()(const double* x, double* residuals, double* jacobian) const {
    const Eigen::Index count = start_.size();
    Eigen::Map<Eigen::VectorXd> r(residuals, count + 1);
    r.setZero();
    const Eigen::VectorXd numbers = numbers_at(Eigen::Map<const Eigen::VectorXd>(x, count));
    if (jacobian == nullptr) {
      r[count] = std::sqrt(error_at(numbers)) / unit_;
      return true;
    }
    const bool at_start = numbers == start_;
    Eigen::MatrixXd gram = at_start ? first_ : gram_at(numbers);
    for (Eigen::Index i = 0; i < count; ++i) {
      gram.row(i) /= scale_[i];
      gram.col(i) /= scale_[i];
      gram(i, i) *= 1.0 + kRidge;
    }
    gram.row(count) /= unit_;
    gram.col(count) /= unit_;
    gram(count, count) *= 1.0 + kRidge;
    const Eigen::LLT<Eigen::MatrixXd> factor(gram);
    Eigen::Map<Eigen::MatrixXd> compressed(jacobian, count + 1, count);
    if (factor.info() != Eigen::Success) {
      // Rank-deficient beyond rounding: the diagonal alone, a gradient step.
      compressed.setZero();
      for (Eigen::Index i = 0; i < count; ++i) compressed(i, i) = std::sqrt(gram(i, i)) + 1e-12;
      r.head(count) = -gram.col(count).head(count).cwiseQuotient(compressed.diagonal().head(count));
      r[count] = std::sqrt(std::max(gram(count, count) - r.head(count).squaredNorm(), 0.0));
      return true;
    }
    const Eigen::MatrixXd upper = factor.matrixU();
    // d residual / d number = -d prediction / d number.
    compressed = -upper.leftCols(count);
    r = upper.col(count);
    return true;
  }

  [[nodiscard]] Eigen::VectorXd numbers_at(const Eigen::VectorXd& x) const {
    return start_ + (x.array() * unit_ / scale_.array()).matrix();
  }
  [[nodiscard]] double error_at(const Eigen::VectorXd& numbers) const {
    unpack(numbers, model_);
    FreeRun run;
    const Eigen::VectorXd residual = residual_of(model_, signals_, run);
    if (!run.finite) return 1e12 * unit_ * unit_;
    double sum = 0.0;
    const auto length = static_cast<Eigen::Index>(blocks_.length);
    for (Eigen::Index n = 0; n < residual.size(); n += length) {
      if (static_cast<int>(blocks_.fold_of(static_cast<std::size_t>(n / length))) ==
          without_fold_) {
        continue;
      }
      sum += residual.segment(n, std::min(length, residual.size() - n)).squaredNorm();
    }
    return sum;
  }

 private:
  // A term of a channel far from 0 comes with a large constant; as long as that is most of the
  // error, the body's numbers follow it instead.  0: it isn't.
  static double offset_step(const Eigen::MatrixXd& gram) {
    const Eigen::Index last = gram.cols() - 1;
    const double product = gram(0, last);
    const bool most = product * product > 0.5 * gram(0, 0) * squared_error(gram);
    return most ? product / gram(0, 0) : 0.0;
  }

  [[nodiscard]] Eigen::MatrixXd gram_at(const Eigen::VectorXd& numbers) const {
    unpack(numbers, model_);
    const Linearisation at = linearised(model_, signals_);
    if (!at.finite) {
      const Eigen::Index size = numbers.size() + 1;
      return Eigen::MatrixXd::Identity(size, size);
    }
    return grams_of(at.jacobian, at.residual, at.run.weight, blocks_).total(blocks_, without_fold_);
  }

  Model& model_;
  const Signals& signals_;
  const Blocks& blocks_;
  int without_fold_;
  Eigen::VectorXd start_;
  Eigen::VectorXd scale_;
  double unit_ = 1.0;
  Eigen::MatrixXd first_;
};

double weight_outside(const std::vector<double>& weight, const Blocks& blocks, int fold) {
  double sum = 0.0;
  for (std::size_t n = 0; n < weight.size(); ++n) {
    if (static_cast<int>(blocks.fold_of(n / blocks.length)) != fold) sum += weight[n];
  }
  return std::max(sum, 1.0);
}

}  // namespace

Blocks make_blocks(const Signals& signals) {
  const auto shortest =
      std::max(kFewestSamples, static_cast<std::size_t>(kShortestBlock_s * signals.rate_hz()));
  Blocks blocks;
  blocks.folds = kFolds;
  blocks.length = std::max(shortest, (signals.size() + kBlocks - 1) / kBlocks);
  if (signals.size() < kFewestBlocks * blocks.length) {
    blocks.length = std::max(kFewestSamples, signals.size() / kFewestBlocks);
  }
  blocks.count = (signals.size() + blocks.length - 1) / blocks.length;
  std::size_t weighing = 0;
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const std::size_t end = std::min(signals.size(), (b + 1) * blocks.length);
    double weight = 0.0;
    for (std::size_t n = b * blocks.length; n < end; ++n) weight += signals.weight()[n];
    if (weight >= 1.0) ++weighing;
  }
  if (signals.size() < kFewestBlocks * kFewestSamples || weighing < kFewestWeighing) {
    throw ConfigError("recording", std::to_string(signals.size()) + " samples",
                      "at least " + std::to_string(kFewestBlocks * kFewestSamples) +
                          " to judge a model on samples it has not seen");
  }
  return blocks;
}

Blocks by_recording(const Blocks& blocks, const Signals& signals) {
  Blocks result = blocks;
  result.folds = signals.stretches().back().recording + 1;
  Eigen::MatrixXd samples = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(result.folds),
                                                  static_cast<Eigen::Index>(blocks.count));
  for (const Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      samples(static_cast<Eigen::Index>(stretch.recording),
              static_cast<Eigen::Index>(n / blocks.length)) += 1.0;
    }
  }
  for (Eigen::Index b = 0; b < samples.cols(); ++b) {
    Eigen::Index most = 0;
    samples.col(b).maxCoeff(&most);
    result.fold.push_back(static_cast<std::size_t>(most));
  }
  return result;
}

Eigen::MatrixXd Grams::total(const Blocks& layout, int without_fold) const {
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(blocks.front().rows(), blocks.front().cols());
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (static_cast<int>(layout.fold_of(b)) != without_fold) sum += blocks[b];
  }
  return sum;
}

Grams grams_of(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
               const std::vector<double>& weight, const Blocks& blocks) {
  const Eigen::Index columns = jacobian.cols();
  Grams grams;
  for (std::size_t b = 0; b < blocks.count; ++b) {
    const auto first = static_cast<Eigen::Index>(b * blocks.length);
    const Eigen::Index rows =
        std::min(static_cast<Eigen::Index>(blocks.length), residual.size() - first);
    Eigen::MatrixXd gram(columns + 1, columns + 1);
    const auto j = jacobian.middleRows(first, rows);
    const auto r = residual.segment(first, rows);
    gram.topLeftCorner(columns, columns).noalias() = j.transpose() * j;
    gram.col(columns).head(columns).noalias() = j.transpose() * r;
    gram.row(columns).head(columns) = gram.col(columns).head(columns).transpose();
    gram(columns, columns) = r.squaredNorm();
    grams.blocks.push_back(std::move(gram));
    double sum = 0.0;
    for (Eigen::Index n = first; n < first + rows; ++n) sum += weight[static_cast<std::size_t>(n)];
    grams.weights.push_back(sum);
  }
  return grams;
}

FitResult fit(Model& model, const Signals& signals, const Blocks& blocks,
              const FitOptions& options) {
  Model work = model;
  Compressed problem(work, signals, blocks, options.without_fold);
  FitResult result;
  const Eigen::VectorXd start = packed(model);
  const double before = problem.error_at(start);
  ceres::TinySolver<Compressed> solver;
  solver.options.max_num_iterations = options.max_iterations;
  solver.options.gradient_tolerance = 1e-12;
  solver.options.parameter_tolerance = 1e-10;
  solver.options.function_tolerance = options.relative_tolerance;
  solver.options.initial_trust_region_radius = 1e7;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(start.size());
  result.iterations = solver.Solve(problem, &x).iterations;
  double after = problem.error_at(problem.numbers_at(x));
  if (after < before) {
    unpack(problem.numbers_at(x), model);
  } else {
    after = before;
  }
  FreeRun run;
  static_cast<void>(residual_of(model, signals, run));
  result.rmse = std::sqrt(after / weight_outside(run.weight, blocks, options.without_fold));
  result.finite = run.finite;
  return result;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

double HeldOut::rmse() const { return std::sqrt(sum_of(squares) / std::max(sum_of(weights), 1.0)); }

HeldOut held_out_linearised(const Grams& grams, const Blocks& blocks) {
  HeldOut result;
  result.finite = true;
  result.weights = grams.weights;
  result.squares.resize(grams.blocks.size());
  const Eigen::Index count = grams.blocks.front().rows() - 1;
  for (std::size_t fold = 0; fold < blocks.folds; ++fold) {
    Eigen::MatrixXd training = grams.total(blocks, static_cast<int>(fold));
    const Eigen::VectorXd scale =
        training.diagonal().head(count).cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd normal =
        scale.asDiagonal() * training.topLeftCorner(count, count) * scale.asDiagonal();
    normal.diagonal().array() += kDeviationRidge;
    const Eigen::VectorXd step =
        scale.asDiagonal() *
        signal::solve_symmetric(normal, scale.asDiagonal() * training.col(count).head(count));
    for (std::size_t b = 0; b < grams.blocks.size(); ++b) {
      if (blocks.fold_of(b) != fold) continue;
      const Eigen::MatrixXd& gram = grams.blocks[b];
      const double square = gram(count, count) - 2.0 * step.dot(gram.col(count).head(count)) +
                            step.dot(gram.topLeftCorner(count, count) * step);
      result.squares[b] = std::max(square, 0.0);
      result.finite = result.finite && std::isfinite(square);
    }
  }
  return result;
}

HeldOut held_out(const Model& model, const Signals& signals, const Blocks& blocks) {
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
    fit(refitted, signals, blocks, options);
    FreeRun run;
    const Eigen::VectorXd residual = residual_of(refitted, signals, run);
    result.finite = result.finite && run.finite;
    for (std::size_t n = 0; n < signals.size(); ++n) {
      const std::size_t block = n / blocks.length;
      if (blocks.fold_of(block) != fold) continue;
      const double r = residual[static_cast<Eigen::Index>(n)];
      result.squares[block] += r * r;
      result.weights[block] += run.weight[n];
    }
  }
  return result;
}

}  // namespace stillhand::diagnosis

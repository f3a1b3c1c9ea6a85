// SPDX-License-Identifier: Apache-2.0
#include "services/diagnosis/core/fitting/fit.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>

namespace stillhand::diagnosis {
namespace {

// Keeps a direction that the data doesn't determine from blowing up; relative to the diagonal.
constexpr double kRidge = 1e-11;

double squared_error(const Eigen::MatrixXd& gram) { return gram(gram.rows() - 1, gram.cols() - 1); }

// The problem as ceres::TinySolver wants it: [J r] compressed to the Cholesky factor of its Gram
// matrix, which has the same J^T J, J^T r and |r|.
class Compressed {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Compressed(Model& model, const Signals& signals, const Blocks& blocks, const FitOptions& options)
      : model_(model), signals_(signals), blocks_(blocks), without_fold_(options.without_fold) {
    start_ = packed(model);
    Eigen::MatrixXd gram = options.at_start != nullptr
                               ? options.at_start->total(blocks, without_fold_)
                               : gram_at(start_);
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
  Compressed problem(work, signals, blocks, options);
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
  result.residual = residual_of(model, signals, result.run);
  result.rmse = std::sqrt(after / weight_outside(result.run.weight, blocks, options.without_fold));
  result.finite = result.run.finite;
  return result;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/fit.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "services/core/diagnosis/model/model_run.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::diagnosis {
namespace {

// Keeps a direction that the data doesn't determine from blowing up; relative to the diagonal.
constexpr double kRidge = 1e-11;
// Of a direction that is held, relative to the others' squares.
constexpr double kHeld = 1e8;

double squared_error(const Eigen::MatrixXd& gram) { return gram(gram.rows() - 1, gram.cols() - 1); }

// A point of the search, so that nothing is computed twice there.
struct Point {
  Eigen::VectorXd numbers;
  Evaluation evaluation;
  double error = 0.0;          // sum of squares outside the fold
  std::optional<Grams> grams;  // where the columns were needed

  [[nodiscard]] bool finite() const { return evaluation.run.free.finite; }
};

// The problem as ceres::TinySolver wants it: [J r] compressed to the Cholesky factor of its Gram
// matrix, which has the same J^T J, J^T r and |r|.
class Compressed {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  Compressed(Model& model, const Signals& signals, const Blocks& blocks, const FitOptions& options)
      : model_(model), signals_(signals), blocks_(blocks), options_(options) {
    const bool stable = is_stable(model.body);
    start_ = packed(model);
    unpack(start_, model);
    if (stable && !is_stable(model.body)) {
      // A pole on its bound, rounded out of it.
      stabilise(model.body);
      start_ = packed(model);
    }
    const bool known = options.at_start != nullptr && signals.start_rows().empty();
    Eigen::MatrixXd gram = known ? total(*options.at_start, model) : gram_at(start_);
    const bool finite = known || accepted_->finite();
    before_ = finite ? squared_error(gram) : kNotFinite;
    if (const double step = offset_step(gram); step != 0.0) {
      start_[0] += step;
      gram = gram_at(start_);
    }
    scale_ = gram.diagonal().head(start_.size()).cwiseSqrt();
    for (Eigen::Index i = 0; i < scale_.size(); ++i) {
      if (!(scale_[i] > 0.0)) scale_[i] = 1.0;
    }
    unit_ = std::sqrt(std::max(squared_error(gram), 1e-300));
    if (!finite) before_ *= unit_ * unit_;
    first_ = gram;
    if (finite && options.without_fold >= 0) hold_poles_on_bound();
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
      ++steps_;
      r[count] = std::sqrt(error_at(numbers)) / unit_;
      return true;
    }
    Eigen::Map<Eigen::MatrixXd> compressed(jacobian, count + 1, count);
    if (steps_ > 0 && steps_ + 1 >= options_.max_iterations) {
      // No step follows: without columns the solver ends here.
      compressed.setZero();
      r[count] = std::sqrt(error_at(numbers)) / unit_;
      return true;
    }
    Eigen::MatrixXd gram = numbers == start_ ? first_ : gram_at(numbers);
    for (Eigen::Index i = 0; i < count; ++i) {
      gram.row(i) /= scale_[i];
      gram.col(i) /= scale_[i];
      gram(i, i) *= 1.0 + kRidge;
    }
    for (const Eigen::VectorXd& held : held_) {
      gram.topLeftCorner(count, count) += kHeld * held * held.transpose();
    }
    gram.row(count) /= unit_;
    gram.col(count) /= unit_;
    gram(count, count) *= 1.0 + kRidge;
    const Eigen::LLT<Eigen::MatrixXd> factor(gram);
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
  // Of the model as it was given.
  [[nodiscard]] double error_before() const { return before_; }
  [[nodiscard]] double error_at(const Eigen::VectorXd& numbers) const {
    const Point& point = point_at(numbers);
    return point.finite() ? point.error : kNotFinite * unit_ * unit_;
  }
  void place(const Eigen::VectorXd& numbers, Model& model) const {
    unpack(numbers, model);
    // Along its bound a pole moves on a curve.
    if (!held_.empty() && !is_stable(model.body)) stabilise(model.body);
  }
  // With columns if the options ask for them.
  [[nodiscard]] Point taken_at(const Eigen::VectorXd& numbers) const {
    return std::move(options_.grams_at_end ? with_columns(numbers) : point_at(numbers));
  }

 private:
  static constexpr double kNotFinite = 1e12;  // [errors at the start]

  // A term of a channel far from 0 comes with a large constant; as long as that is most of the
  // error, the body's numbers follow it instead.  0: it isn't.
  static double offset_step(const Eigen::MatrixXd& gram) {
    const Eigen::Index last = gram.cols() - 1;
    const double product = gram(0, last);
    const bool most = product * product > 0.5 * gram(0, 0) * squared_error(gram);
    return most ? product / gram(0, 0) : 0.0;
  }

  // A refit without a fold has few steps, and begins at the end of the fit to all.  A pole on its
  // bound that the data push out would have each of them refused: it stays there, and the other
  // numbers move.
  void hold_poles_on_bound() {
    const Eigen::Index count = start_.size();
    unpack(start_, model_);
    std::vector<Eigen::VectorXd> radii = radii_on_bound(model_);
    if (radii.empty()) return;
    Eigen::MatrixXd normal = scale_.cwiseInverse().asDiagonal() *
                             first_.topLeftCorner(count, count) *
                             scale_.cwiseInverse().asDiagonal();
    normal.diagonal().array() += kRidge;
    const Eigen::VectorXd step =
        signal::solve_symmetric(normal, first_.col(count).head(count).cwiseQuotient(scale_));
    for (const Eigen::VectorXd& radius : radii) {
      const Eigen::VectorXd scaled = radius.cwiseQuotient(scale_);
      if (scaled.dot(step) > 0.0) held_.push_back(scaled.normalized());
    }
  }

  [[nodiscard]] Eigen::MatrixXd total(const Grams& grams, const Model& model) const {
    Eigen::MatrixXd gram = grams.total(blocks_, options_.without_fold);
    if (options_.prior != nullptr) options_.prior->add(model, gram);
    return gram;
  }

  [[nodiscard]] Point& point_at(const Eigen::VectorXd& numbers) const {
    for (std::optional<Point>* each : {&tried_, &accepted_}) {
      if (*each && (*each)->numbers == numbers) return **each;
    }
    place(numbers, model_);
    tried_.emplace(Point{numbers, evaluated(model_, signals_), 0.0, {}});
    const Eigen::VectorXd& residual = tried_->evaluation.residual;
    const auto length = static_cast<Eigen::Index>(blocks_.length);
    for (Eigen::Index n = 0; n < residual.size(); n += length) {
      if (static_cast<int>(blocks_.fold_of(static_cast<std::size_t>(n / length))) ==
          options_.without_fold) {
        continue;
      }
      tried_->error += residual.segment(n, std::min(length, residual.size() - n)).squaredNorm();
    }
    if (options_.prior != nullptr) tried_->error += options_.prior->error(model_);
    return *tried_;
  }

  Point& with_columns(const Eigen::VectorXd& numbers) const {
    const Point& point = point_at(numbers);
    if (tried_ && &point == &*tried_) accepted_.swap(tried_);
    if (accepted_->finite() && !accepted_->grams) {
      place(numbers, model_);
      const Evaluation& at = accepted_->evaluation;
      accepted_->grams =
          grams_of(jacobian_of(model_, signals_, at), at.residual, at.run.free.weight, blocks_);
    }
    return *accepted_;
  }

  [[nodiscard]] Eigen::MatrixXd gram_at(const Eigen::VectorXd& numbers) const {
    const Point& point = with_columns(numbers);
    if (point.grams) {
      place(numbers, model_);
      return total(*point.grams, model_);
    }
    const Eigen::Index size = numbers.size() + 1;
    return Eigen::MatrixXd::Identity(size, size);
  }

  Model& model_;
  const Signals& signals_;
  const Blocks& blocks_;
  const FitOptions& options_;
  Eigen::VectorXd start_;
  Eigen::VectorXd scale_;
  double unit_ = 1.0;
  double before_ = 0.0;
  Eigen::MatrixXd first_;
  std::vector<Eigen::VectorXd> held_;  // directions of the scaled numbers
  mutable int steps_ = 0;
  mutable std::optional<Point> tried_;     // the newest
  mutable std::optional<Point> accepted_;  // the newest of which the solver wanted the columns
};

double weight_outside(const std::vector<double>& weight, const Blocks& blocks, int fold) {
  double sum = 0.0;
  for (std::size_t n = 0; n < weight.size(); ++n) {
    if (static_cast<int>(blocks.fold_of(n / blocks.length)) != fold) sum += weight[n];
  }
  return std::max(sum, 1.0);
}

std::vector<bool> rows_outside(const Signals& signals, const Blocks& blocks, int fold) {
  std::vector<bool> rows(signals.size());
  for (std::size_t n = 0; n < rows.size(); ++n) {
    rows[n] = static_cast<int>(blocks.fold_of(n / blocks.length)) != fold;
  }
  return rows;
}

}  // namespace

FitResult fit(Model& model, const Signals& all, const Blocks& blocks, const FitOptions& options) {
  const bool lasts = options.without_fold >= 0 && all.slow_poles();
  std::optional<Signals> own;
  if (lasts) own = all.starting_by(rows_outside(all, blocks, options.without_fold));
  const Signals& signals = own ? *own : all;
  Model work = model;
  Compressed problem(work, signals, blocks, options);
  FitResult result;
  ceres::TinySolver<Compressed> solver;
  solver.options.max_num_iterations = options.max_iterations;
  solver.options.gradient_tolerance = 1e-12;
  solver.options.parameter_tolerance = 1e-10;
  solver.options.function_tolerance = options.relative_tolerance;
  solver.options.initial_trust_region_radius = 1e7;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem.NumParameters());
  solver.Solve(problem, &x);
  Eigen::VectorXd numbers = problem.numbers_at(x);
  double error = problem.error_at(numbers);
  if (error < problem.error_before()) {
    problem.place(numbers, model);
  } else {
    error = problem.error_before();
    numbers = packed(model);
  }
  Point end = problem.taken_at(numbers);
  result.residual = std::move(end.evaluation.residual);
  result.grams = std::move(end.grams);
  result.run = std::move(end.evaluation.run.free);
  result.rmse = std::sqrt(error / weight_outside(result.run.weight, blocks, options.without_fold));
  result.finite = result.run.finite;
  return result;
}

}  // namespace stillhand::diagnosis

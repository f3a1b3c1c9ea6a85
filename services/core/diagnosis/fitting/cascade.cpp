// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/cascade.hpp"

#include <ceres/tiny_solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <tuple>

#include "services/core/diagnosis/fitting/shape_exchange.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/diagnosis/model/modes.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

using Polynomial = std::vector<double>;  // by powers of q^-1

struct Path {
  Polynomial numerator;
  Polynomial denominator{1.0};
};

struct Cascade {
  Path before;
  Effect curve;
  Path behind;
  double offset = 0.0;
  double error = HUGE_VAL;  // sum of squares over the output's variance
};

std::vector<double> through(const std::vector<double>& x, const Path& path,
                            const std::vector<Stretch>& stretches) {
  return through_path(x, path.numerator, path.denominator, stretches);
}

struct CascadeRun {
  std::vector<double> argument;
  std::vector<double> phi;
  Eigen::VectorXd residual;
};

// The cascade's numbers as ceres::TinySolver wants them: denominators, numerators and the heights
// that are free, polynomials in the basis of Eq. DG-8.
class CascadeFit {
 public:
  using Scalar = double;
  enum { NUM_RESIDUALS = Eigen::Dynamic, NUM_PARAMETERS = Eigen::Dynamic };

  CascadeFit(const Body& like, const Cascade& start, const Signals& signals)
      : like_(like), start_(start), signals_(signals) {
    weight_ = Eigen::Map<const Eigen::VectorXd>(signals.weight().data(), NumResiduals());
    for (const Stretch& stretch : signals.stretches()) {
      const auto skipped = static_cast<Eigen::Index>((stretch.end - stretch.first) / kUnknownStart);
      weight_.segment(static_cast<Eigen::Index>(stretch.first), skipped).setZero();
    }
    weight_ = weight_.cwiseSqrt() / signals.output().deviation;
  }

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(signals_.size()); }
  [[nodiscard]] int NumParameters() const { return static_cast<int>(packed(start_).size()); }

  bool operator()(const double* x, double* residuals, double* jacobian) const {
    const Eigen::VectorXd numbers = Eigen::Map<const Eigen::VectorXd>(x, NumParameters());
    Eigen::Map<Eigen::VectorXd> residual(residuals, NumResiduals());
    residual = residual_at(numbers);
    if (jacobian == nullptr) return true;
    Eigen::Map<Eigen::MatrixXd> columns(jacobian, NumResiduals(), NumParameters());
    for (Eigen::Index i = 0; i < numbers.size(); ++i) {
      const double step = kStep * std::max(std::abs(numbers[i]), kLeast);
      const auto moved_by = [&](double by) {
        Eigen::VectorXd moved = numbers;
        moved[i] += by;
        return residual_at(moved);
      };
      // A pole on its bound goes one way alone.
      Eigen::VectorXd moved = moved_by(step);
      const double by = is_refused(moved) ? -step : step;
      if (by < 0.0) moved = moved_by(by);
      columns.col(i) = (moved - residual) / by;
    }
    return true;
  }

  [[nodiscard]] Cascade at(const Eigen::VectorXd& numbers) const {
    Cascade result = start_;
    const double* next = numbers.data();
    const auto take = [&next](std::size_t count) {
      const double* first = next;
      next += count;
      return difference_basis({first, next});
    };
    result.offset = *next++;
    for (Path* path : {&result.before, &result.behind}) {
      std::ranges::copy(take(path->denominator.size() - 1), path->denominator.begin() + 1);
      path->numerator = take(path->numerator.size());
    }
    for (Parameter& parameter : result.curve.parameters) {
      if (parameter.fitted) parameter.value = std::clamp(*next++, parameter.lower, parameter.upper);
    }
    return result;
  }

  [[nodiscard]] CascadeRun run(const Cascade& cascade) const {
    const auto& stretches = signals_.stretches();
    CascadeRun run;
    run.argument = through(signals_.inputs().front().values, cascade.before, stretches);
    const Nonlinearity law = effect_kind(cascade.curve.kind).feedback(cascade.curve);
    LoopMemory none;
    for (const double z : run.argument) run.phi.push_back(law.phi(z, none));
    const std::vector<double> y = through(run.phi, cascade.behind, stretches);
    run.residual.resize(std::ssize(y));
    for (std::size_t n = 0; n < y.size(); ++n) {
      const auto i = static_cast<Eigen::Index>(n);
      run.residual[i] = weight_[i] == 0.0
                            ? 0.0
                            : weight_[i] * (signals_.output().values[n] - cascade.offset - y[n]);
    }
    return run;
  }

  [[nodiscard]] bool is_stable(const Cascade& cascade) const {
    Body body = like_;
    body.denominator = product(cascade.before.denominator, cascade.behind.denominator);
    return diagnosis::is_stable(body);
  }

  static Eigen::VectorXd packed(const Cascade& cascade) {
    std::vector<double> all{cascade.offset};
    const auto append = [&all](const std::vector<double>& values) {
      const std::vector<double> basis = difference_basis(values);
      all.insert(all.end(), basis.begin(), basis.end());
    };
    for (const Path* path : {&cascade.before, &cascade.behind}) {
      append({path->denominator.begin() + 1, path->denominator.end()});
      append(path->numerator);
    }
    for (const Parameter& parameter : cascade.curve.parameters) {
      if (parameter.fitted) all.push_back(parameter.value);
    }
    return Eigen::Map<const Eigen::VectorXd>(all.data(), std::ssize(all));
  }

 private:
  static constexpr std::size_t kUnknownStart = 10;  // a tenth of a stretch, from rest at 0
  static constexpr double kStep = 1e-6;
  static constexpr double kLeast = 1e-3;
  static constexpr double kRefused = 1e3;  // [deviations of the output] at each sample

  [[nodiscard]] Eigen::VectorXd residual_at(const Eigen::VectorXd& numbers) const {
    const Cascade cascade = at(numbers);
    if (is_stable(cascade)) {
      Eigen::VectorXd residual = run(cascade).residual;
      if (residual.allFinite()) return residual;
    }
    return Eigen::VectorXd::Constant(NumResiduals(), kRefused);
  }

  static bool is_refused(const Eigen::VectorXd& residual) {
    return residual[residual.size() - 1] == kRefused;
  }

  const Body& like_;
  const Cascade& start_;
  const Signals& signals_;
  Eigen::VectorXd weight_;
};

Cascade fitted(const Body& like, const Cascade& start, const Signals& signals, int iterations) {
  const CascadeFit problem(like, start, signals);
  ceres::TinySolver<CascadeFit> solver;
  solver.options.max_num_iterations = iterations;
  solver.options.function_tolerance = 1e-8;
  solver.options.gradient_tolerance = 1e-12;
  Eigen::VectorXd numbers = CascadeFit::packed(start);
  solver.Solve(problem, &numbers);
  Cascade result = problem.at(numbers);
  result.error = problem.is_stable(result) ? problem.run(result).residual.squaredNorm() : HUGE_VAL;
  return result;
}

// The same curve with its knots where the argument has come to lie.
std::optional<Cascade> redrawn(Cascade cascade, const Body& like, const EffectKind& drawer,
                               const Signals& signals) {
  const CascadeRun run = CascadeFit(like, cascade, signals).run(cascade);
  std::optional<Effect> curve = drawer.drawn_after(run.argument, run.phi, signals.weight());
  if (!curve) return {};
  cascade.curve = *std::move(curve);
  return cascade;
}

// Within the body's bounds for its poles.
Polynomial bounded(const Polynomial& denominator, const Body& like) {
  Body body = like;
  body.denominator = denominator;
  if (!is_stable(body)) stabilise(body);
  return body.denominator;
}

// Without a bend: the argument has a deviation of 1, and the gain is the one of least squares.
std::optional<Cascade> started(const Polynomial& before, const Polynomial& behind,
                               const EffectKind& drawer, const Signals& signals) {
  const auto flat = [](const Polynomial& denominator) {
    Path path{Polynomial(denominator.size(), 0.0), denominator};
    path.numerator.front() = 1.0;
    return path;
  };
  Cascade start{flat(before), {}, flat(behind)};
  const auto& stretches = signals.stretches();
  std::vector<double> z = through(signals.inputs().front().values, start.before, stretches);
  Eigen::Map<Eigen::VectorXd> argument(z.data(), std::ssize(z));
  const double deviation = std::sqrt((argument.array() - argument.mean()).square().mean());
  if (!(deviation > 0.0) || !std::isfinite(deviation)) return {};
  start.before.numerator.front() /= deviation;
  argument /= deviation;
  std::optional<Effect> curve = drawer.drawn_after(z, z, signals.weight());
  if (!curve) return {};
  start.curve = *std::move(curve);
  const std::vector<double> y = through(z, start.behind, stretches);
  const auto about_mean = [&](const std::vector<double>& x) {
    const Eigen::Map<const Eigen::ArrayXd> values(x.data(), std::ssize(x));
    const Eigen::Map<const Eigen::ArrayXd> weight(signals.weight().data(), std::ssize(x));
    return Eigen::VectorXd(weight * (values - (weight * values).sum() / weight.sum()));
  };
  const Eigen::VectorXd answer = about_mean(y);
  const double gain = answer.dot(about_mean(signals.output().values)) / answer.squaredNorm();
  if (gain == 0.0 || !std::isfinite(gain)) return {};
  start.behind.numerator.front() = gain;
  start.offset = signals.output().mean;
  return start;
}

using Poles = std::vector<std::complex<double>>;

// The fastest first; the two of a pair are neighbours.
Poles poles_of(const Polynomial& denominator) {
  Poles poles = signal::poles({1.0, denominator, denominator});
  std::ranges::sort(poles, {}, [](const std::complex<double>& pole) {
    return std::tuple(-std::abs(1.0 - pole), pole.real(), pole.imag());
  });
  return poles;
}

// The first ones, and the others.  A pair that is torn apart leaves a real pole on either side.
std::array<Poles, 2> shared_out(Poles poles, std::size_t split) {
  std::complex<double>& last = poles[split - 1];
  std::complex<double>& next = poles[split];
  if (last.imag() != 0.0 && std::abs(last - std::conj(next)) < 1e-9) {
    last = next = std::copysign(std::abs(last), last.real());
  }
  const auto middle = poles.begin() + static_cast<std::ptrdiff_t>(split);
  return {Poles(poles.begin(), middle), Poles(middle, poles.end())};
}

Model as_model(const Cascade& cascade, const Model& like) {
  Model result = like;
  const auto& [before, curve, behind, offset, error] = cascade;
  result.body.offset = offset;
  result.body.denominator = product(before.denominator, behind.denominator);
  std::ranges::fill(result.body.numerators.front(), 0.0);
  result.effects.back() = curve;
  result.effects.back().coefficients = coefficients_of(
      {product(before.denominator, behind.numerator), product(before.numerator, behind.denominator),
       Polynomial(result.body.denominator.size(), 0.0)});
  return result;
}

}  // namespace

std::optional<Model> cascade(const Model& model, const EffectKind& drawer, const Signals& signals) {
  constexpr int kFirst = 40;  // steps of each, and of the best one with knots where z lies by then
  constexpr int kLast = 60;
  if (model.inputs.size() != 1) return {};
  const Poles all = poles_of(model.body.denominator);
  Cascade best;
  for (std::size_t split = 1; split < all.size(); ++split) {
    const std::array<Poles, 2> poles = shared_out(all, split);
    for (const bool slow_first : {false, true}) {
      auto start = started(bounded(denominator_with(poles[slow_first ? 1 : 0]), model.body),
                           bounded(denominator_with(poles[slow_first ? 0 : 1]), model.body), drawer,
                           signals);
      if (!start) continue;
      Cascade tried = fitted(model.body, *start, signals, kFirst);
      if (tried.error < best.error) best = std::move(tried);
    }
  }
  for (int pass = 0; pass < 2 && std::isfinite(best.error); ++pass) {
    const auto start = redrawn(best, model.body, drawer, signals);
    if (!start) break;
    Cascade tried = fitted(model.body, *start, signals, kLast);
    if (tried.error < best.error) best = std::move(tried);
  }
  if (!std::isfinite(best.error)) return {};
  return as_model(best, model);
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "services/core/next_run/contest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/contract/config_error.hpp"
#include "services/core/diagnosis/fitting/fit.hpp"
#include "services/core/diagnosis/fitting/noise_model.hpp"
#include "services/core/diagnosis/model/effect_kind.hpp"
#include "services/core/diagnosis/model/evaluation.hpp"
#include "services/core/diagnosis/model/loop.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::next_run {
namespace {

using diagnosis::Measurement;
using diagnosis::Model;
using diagnosis::Signals;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kBlock_s = 2.0;         // longer than the body's memory, Eq. DG-11
constexpr double kUndetermined = 1e-10;  // of the largest eigenvalue, Eq. DG-70
constexpr double kNeverFits = 1e12;      // [-] a run that is not finite
constexpr double kAsGood = 1.0;          // [-] evidence, Eq. NR-13

// The inverse where the data determine it, nothing elsewhere.
MatrixXd inverse(const MatrixXd& squares) {
  const VectorXd scale =
      squares.diagonal().unaryExpr([](double x) { return x > 0.0 ? 1.0 / std::sqrt(x) : 0.0; });
  const auto [values, vectors] =
      signal::symmetric_eigenvectors(scale.asDiagonal() * squares * scale.asDiagonal());
  const double least = kUndetermined * std::max(values.tail(1)[0], 1e-300);
  const VectorXd inverted =
      values.unaryExpr([least](double x) { return x > least ? 1.0 / x : 0.0; });
  const MatrixXd root = scale.asDiagonal() * vectors;
  return root * inverted.asDiagonal() * root.transpose();
}

// Places of the numbers of the effects that are so, in packed()'s order.
template <typename Predicate>
std::vector<Index> numbers_of(const Model& model, const Predicate& is_so) {
  Model bare = model;
  bare.effects.clear();
  Index next = diagnosis::packed(bare).size();
  std::vector<Index> places;
  for (const diagnosis::Effect& effect : model.effects) {
    const Index end = next + std::ssize(effect.coefficients) +
                      std::ranges::count_if(effect.parameters, &diagnosis::Parameter::fitted);
    for (; next < end; ++next) {
      if (is_so(effect)) places.push_back(next);
    }
  }
  return places;
}

// A further recording does not share them.
std::vector<Index> own_numbers(const Model& model) {
  return numbers_of(model, [](const diagnosis::Effect& effect) {
    return diagnosis::effect_kind(effect.kind).time_only(effect);
  });
}

// Forgets what is known of these numbers, and of the others through them: the Schur complement.
MatrixXd without(const MatrixXd& information, const std::vector<Index>& own) {
  if (own.empty()) return information;
  const MatrixXd columns = information(Eigen::all, own);
  MatrixXd left = information - columns * inverse(information(own, own)) * columns.transpose();
  left(own, Eigen::all).setZero();
  left(Eigen::all, own).setZero();
  return left;
}

// Sums over blocks of a stretch each.
std::vector<double> block_sums(const VectorXd& values, const Signals& signals) {
  std::vector<double> sums;
  constexpr std::size_t kFewestSamples = 5;  // two seconds of a slow record have none, Eq. DG-16
  const auto length =
      std::max(kFewestSamples, static_cast<std::size_t>(kBlock_s * signals.rate_hz()));
  for (const diagnosis::Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first; n < stretch.end; n += length) {
      const std::size_t count = std::min(length, stretch.end - n);
      sums.push_back(values.segment(static_cast<Index>(n), static_cast<Index>(count)).sum());
    }
  }
  return sums;
}

// Variance of the sum of all blocks, from their scatter.
double variance_of_sum(const std::vector<double>& sums) {
  const auto count = static_cast<double>(sums.size());
  double mean = 0.0;
  for (const double sum : sums) mean += sum / count;
  double square = 0.0;
  for (const double sum : sums) square += (sum - mean) * (sum - mean);
  return count < 2.0 ? 0.0 : square * count / (count - 1.0);
}

// Of a sum over one recording.
double error_of_sum(const VectorXd& values, const Signals& signals) {
  return std::sqrt(variance_of_sum(block_sums(values, signals)));
}

// ln det(I + S), S being the information in units of `of_a_sample`.
double price_of(const MatrixXd& information, const VectorXd& of_a_sample) {
  const VectorXd scale =
      of_a_sample.unaryExpr([](double x) { return x > 0.0 ? 1.0 / std::sqrt(x) : 0.0; });
  const VectorXd values =
      signal::symmetric_eigenvalues(scale.asDiagonal() * information * scale.asDiagonal());
  return values.unaryExpr([](double x) { return std::log1p(std::max(x, 0.0)); }).sum();
}

// Where a stretch begins to be judged, the noise model of so many taps lacks the past that makes
// its error one of the noise's size: those rows are left out.
template <typename Columns>
void leave_out_starts(const Signals& signals, std::size_t taps, Columns& columns) {
  for (const diagnosis::Stretch& stretch : signals.stretches()) {
    std::size_t first = stretch.first;
    while (first < stretch.end && !(signals.weight()[first] > 0.0)) ++first;
    const std::size_t end = std::min(stretch.end, first + std::max<std::size_t>(taps, 1) - 1);
    columns.middleRows(static_cast<Index>(first), static_cast<Index>(end - first)).setZero();
  }
}

diagnosis::Linearisation judged_line(const Model& model, const Signals& signals, std::size_t taps) {
  diagnosis::Linearisation line = diagnosis::linearised(model, signals);
  if (!line.finite) return line;
  leave_out_starts(signals, taps, line.residual);
  leave_out_starts(signals, taps, line.jacobian);
  return line;
}

double count_of(const Signals& signals) {
  double samples = 0.0;
  for (const double weight : signals.weight()) samples += weight;
  return samples;
}

// Errors and prices of each candidate over one recording into the evidence.
void add(const std::vector<VectorXd>& residuals, const std::vector<double>& prices,
         const Signals& signals, double variance, Evidence& evidence) {
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    for (std::size_t j = 0; j < residuals.size(); ++j) {
      if (i == j) continue;
      const VectorXd difference =
          (residuals[j].array().square() - residuals[i].array().square()) / variance;
      double& error = evidence.standard_error(static_cast<Index>(i), static_cast<Index>(j));
      error = std::hypot(error, error_of_sum(difference, signals));
      evidence.twice_log_ratio(static_cast<Index>(i), static_cast<Index>(j)) +=
          difference.sum() + prices[j] - prices[i];
    }
  }
}

}  // namespace

bool Evidence::settled(Index i, Index j) const {
  return twice_log_ratio(i, j) >= std::max(kStrong, kStandardErrors * standard_error(i, j));
}

Index Evidence::winner() const {
  const std::vector<Index> all = left();
  if (all.size() != 1) return -1;
  for (Index j = 0; j < twice_log_ratio.cols(); ++j) {
    if (j != all.front() && !settled(all.front(), j)) return -1;
  }
  return all.front();
}

std::vector<Index> Evidence::left() const {
  std::vector<Index> all;
  for (Index i = 0; i < twice_log_ratio.rows(); ++i) {
    bool beaten = false;
    for (Index j = 0; j < twice_log_ratio.rows(); ++j) beaten = beaten || (j != i && settled(j, i));
    if (!beaten) all.push_back(i);
  }
  return all;
}

Contest::Contest(std::vector<Candidate> candidates, const Signals& signals)
    : candidates_(std::move(candidates)),
      inputs_(candidates_.front().model.inputs),
      band_hz_(signals.lowest_excited_hz(), signals.highest_excited_hz()) {
  diagnosis::FreeRun run;
  taps_ = diagnosis::whitening_taps(diagnosis::residual_of(candidates_.front().model, signals, run),
                                    signals);
  weigh(signals.whitened(taps_));
}

// Eq. NR-2.
void Contest::weigh(const Signals& judged) {
  const auto count = static_cast<Index>(candidates_.size());
  const double samples = count_of(judged);
  std::vector<diagnosis::Linearisation> lines;
  for (Candidate& candidate : candidates_) lines.push_back(fitted(candidate, judged));
  const auto squares = [](const diagnosis::Linearisation& line) {
    return line.residual.squaredNorm();
  };
  const Index best = std::ranges::min_element(lines, {}, squares) - lines.begin();
  variance_ = squares(lines[static_cast<std::size_t>(best)]) / samples;
  meet(static_cast<std::size_t>(best), judged, lines);
  std::vector<VectorXd> residuals;
  for (diagnosis::Linearisation& line : lines) {
    variance_ = std::min(variance_, squares(line) / samples);
    information_.push_back(line.jacobian.transpose() * line.jacobian);
    residuals.push_back(std::move(line.residual));
  }
  std::vector<double> prices;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    information_[i] /= variance_;
    of_a_sample_.push_back(information_[i].diagonal() / samples);
    prices.push_back(price_of(information_[i], of_a_sample_[i]));
    information_[i] = without(information_[i], own_numbers(candidates_[i].model));
  }
  before_ = {MatrixXd::Zero(count, count), MatrixXd::Zero(count, count)};
  add(residuals, prices, judged, variance_, before_);
}

// Steps of Gauss and Newton of the cause's numbers, the others held.
diagnosis::Linearisation Contest::cause_fitted(Candidate& candidate, const Signals& judged) const {
  constexpr int kSteps = 3;  // most causes are linear in their numbers
  const std::vector<Index> own = numbers_of(
      candidate.model, [&](const diagnosis::Effect& each) { return &each == &candidate.cause(); });
  diagnosis::Linearisation line = judged_line(candidate.model, judged, taps_.size());
  for (int step = 0; step < kSteps && line.finite; ++step) {
    const MatrixXd columns = line.jacobian(Eigen::all, own);
    VectorXd numbers = diagnosis::packed(candidate.model);
    numbers(own) += inverse(columns.transpose() * columns) * columns.transpose() * line.residual;
    diagnosis::unpack(numbers, candidate.model);
    line = judged_line(candidate.model, judged, taps_.size());
  }
  return line;
}

diagnosis::Linearisation Contest::fitted(Candidate& candidate, const Signals& judged) const {
  diagnosis::fit(candidate.model, judged, diagnosis::make_blocks(judged));
  diagnosis::Linearisation line = judged_line(candidate.model, judged, taps_.size());
  if (!line.finite) {
    throw ConfigError("candidate " + name_of(candidate), "a run that is not finite",
                      "a model that was fitted to the recording");
  }
  return line;
}

// Eq. NR-13.
void Contest::meet(std::size_t best, const Signals& judged,
                   std::vector<diagnosis::Linearisation>& lines) {
  const Candidate& leader = candidates_[best];
  for (std::size_t j = 0; j < candidates_.size(); ++j) {
    const diagnosis::Effect& cause = candidates_[j].cause();
    const auto is_cause = [&](const diagnosis::Effect& each) { return is_same(each, cause); };
    if (std::ranges::any_of(leader.model.effects, is_cause)) continue;  // the leader itself, too
    Candidate near = leader;
    near.heldout_rmse = candidates_[j].heldout_rmse;
    near.model.effects[near.effect] =
        at_order(cause, candidates_[j].model.body.order(), leader.model.body.order());
    const double most = lines[j].residual.squaredNorm() + kAsGood * variance_;
    diagnosis::Linearisation line = cause_fitted(near, judged);
    if (!line.finite) continue;
    if (line.residual.squaredNorm() > most) line = fitted(near, judged);
    if (line.residual.squaredNorm() > most) continue;
    candidates_[j] = std::move(near);
    lines[j] = std::move(line);
  }
}

std::vector<Candidate> Contest::still_tied() const {
  std::vector<Candidate> tied;
  for (const Index i : before_.left()) tied.push_back(candidates_[static_cast<std::size_t>(i)]);
  return tied;
}

Signals Contest::signals_of(const Measurement& run) const {
  return {run, inputs_, candidates_.front().model.output};
}

std::vector<double> Contest::prediction(std::size_t i, const Measurement& run) const {
  return diagnosis::free_run(candidates_[i].model, signals_of(run)).prediction;
}

// Eq. NR-3, by Levenberg and Marquardt.
Contest::Refit Contest::refitted(std::size_t j, const Signals& run, int steps) const {
  Model model = candidates_[j].model;
  const VectorXd start = diagnosis::packed(model);
  const MatrixXd& information = information_[j];
  const auto known = [&](const Model& at) {
    const VectorXd moved = diagnosis::packed(at) - start;
    return moved.dot(information * moved);
  };
  diagnosis::Linearisation line = judged_line(model, run, taps_.size());
  if (!line.finite) {
    const auto size = static_cast<Index>(run.size());
    const double each = std::sqrt(kNeverFits * variance_ / static_cast<double>(size));
    return {kNeverFits, 0.0, 0.0, VectorXd::Constant(size, each)};
  }
  const MatrixXd more = line.jacobian.transpose() * line.jacobian / variance_;
  const double price =
      price_of(information + more, of_a_sample_[j]) - price_of(information, of_a_sample_[j]);
  Refit best{line.residual.squaredNorm() / variance_, 0.0, price, line.residual};
  for (int step = 0;; ++step) {
    const VectorXd numbers = diagnosis::packed(model);
    const VectorXd downhill =
        line.jacobian.transpose() * line.residual / variance_ - information * (numbers - start);
    const MatrixXd squares = line.jacobian.transpose() * line.jacobian / variance_ + information;
    const VectorXd way = inverse(squares) * downhill;
    if (steps == 0) {
      best.cost -= way.dot(downhill);
      best.residual -= line.jacobian * way;
      return best;
    }
    bool better = false;
    for (const double damping : {0.0, 0.01, 0.1, 1.0, 10.0, 100.0}) {
      if (better) break;
      MatrixXd damped = squares;
      damped.diagonal() *= 1.0 + damping;
      Model next = model;
      diagnosis::unpack(numbers + inverse(damped) * downhill, next);
      if (!is_stable(next.body)) continue;
      diagnosis::FreeRun free;
      VectorXd residual = diagnosis::residual_of(next, run, free);
      if (!free.finite) continue;
      leave_out_starts(run, taps_.size(), residual);
      const double cost = residual.squaredNorm() / variance_ + known(next);
      better = cost < best.cost;
      if (better) {
        best = {cost, known(next), price, residual};
        model = std::move(next);
      }
    }
    if (!better || step + 1 == steps) return best;
    line = judged_line(model, run, taps_.size());
  }
}

std::optional<Signals> Contest::as_predicted(std::size_t i, const Measurement& run) const {
  const diagnosis::FreeRun free = diagnosis::free_run(candidates_[i].model, signals_of(run));
  if (!free.finite) return std::nullopt;
  Measurement predicted = run;
  for (diagnosis::Channel& channel : predicted.channels) {
    if (channel.name == candidates_[i].model.output) channel.values = free.prediction;
  }
  return signals_of(predicted).whitened(taps_);
}

Expected Contest::expected(const Measurement& run, int steps) const {
  const auto count = static_cast<Index>(candidates_.size());
  Expected expected{MatrixXd::Zero(count, count), MatrixXd::Zero(count, count),
                    VectorXd::Zero(count)};
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const std::optional<Signals> judged = as_predicted(i, run);
    for (std::size_t j = 0; judged && j < candidates_.size(); ++j) {
      const auto row = static_cast<Index>(i);
      const auto column = static_cast<Index>(j);
      const Refit refit = refitted(j, *judged, i == j ? 0 : steps);
      expected.price[column] = refit.price;
      if (i == j) continue;
      const VectorXd squares = refit.residual.array().square() / variance_;
      expected.separation(row, column) = refit.cost;
      // The scatter of what is left, and of its product with the noise.
      expected.standard_error(row, column) =
          std::hypot(error_of_sum(squares, *judged), 2.0 * std::sqrt(squares.sum()));
    }
  }
  return expected;
}

VectorXd Contest::unmatched(std::size_t i, std::size_t j, const Measurement& run, int steps) const {
  const std::optional<Signals> judged = as_predicted(i, run);
  if (!judged) return VectorXd::Zero(static_cast<Index>(run.size()));
  return refitted(j, *judged, steps).residual;
}

MatrixXd Contest::margin(const Expected& expected) const {
  const Index count = expected.separation.rows();
  MatrixXd margins = MatrixXd::Zero(count, count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j < count; ++j) {
      if (i == j) continue;
      const double apart = std::max(expected.separation(i, j), 1e-9);
      const double wanted =
          std::max(kStrong, kStandardErrors * std::hypot(expected.standard_error(i, j),
                                                         before_.standard_error(i, j)));
      const double evidence =
          before_.twice_log_ratio(i, j) + apart + expected.price[j] - expected.price[i];
      margins(i, j) = (evidence - wanted) / (2.0 * std::sqrt(apart));
    }
  }
  return margins;
}

MatrixXd Contest::chance(const Expected& expected) const {
  MatrixXd chances =
      margin(expected).unaryExpr([](double z) { return statistics::normal_below(z); });
  chances.diagonal().setZero();
  return chances;
}

double Contest::probability_settled(const Expected& expected) const {
  const MatrixXd chances = chance(expected);
  const auto count = chances.rows();
  double sum = 0.0;
  for (Index i = 0; i < count; ++i) {
    double missed = 0.0;
    for (Index j = 0; j < count; ++j) missed += i == j ? 0.0 : 1.0 - chances(i, j);
    sum += std::max(0.0, 1.0 - missed) / static_cast<double>(count);
  }
  return sum;
}

// Eq. NR-4.
Evidence Contest::with(const Measurement& run) const {
  constexpr int kSteps = 20;
  const Signals judged = signals_of(run).whitened(taps_);
  const double samples = count_of(judged);
  std::vector<VectorXd> residuals;
  std::vector<double> prices;
  double variance = std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < candidates_.size(); ++j) {
    Refit refit = refitted(j, judged, kSteps);
    variance = std::min(variance, refit.cost * variance_ / samples);
    prices.push_back(refit.price + refit.known);
    residuals.push_back(std::move(refit.residual));
  }
  Evidence evidence = before_;
  add(residuals, prices, judged, std::max(variance, variance_), evidence);
  return evidence;
}

}  // namespace stillhand::next_run

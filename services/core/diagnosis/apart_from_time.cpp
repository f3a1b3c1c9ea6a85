// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/apart_from_time.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/diagnosis/fitting/held_out.hpp"
#include "services/core/diagnosis/selection.hpp"
#include "services/core/signal/decompositions.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr int kHalfCosines = 3;  // as many as the richest form of a drift, Eq. DG-32
constexpr double kSlow = 0.3;    // of the variance, beyond the half-cosines
constexpr int kTimeIterations = 10;

// The channel as a smooth function of time, Eq. DG-59: a constant and the slowest half-cosines over
// the record.
std::vector<double> smooth_of(const std::vector<double>& x, const Signals& signals) {
  const auto rows = static_cast<Eigen::Index>(x.size());
  Eigen::MatrixXd shapes(rows, kHalfCosines + 1);
  for (Eigen::Index n = 0; n < rows; ++n) {
    const double t = (signals.time_s()[static_cast<std::size_t>(n)] - signals.time_s().front()) /
                     signals.duration_s();
    for (int k = 0; k <= kHalfCosines; ++k) shapes(n, k) = std::cos(std::numbers::pi * k * t);
  }
  const Eigen::Map<const Eigen::VectorXd> values(x.data(), rows);
  const Eigen::VectorXd weights =
      signal::solve_symmetric(shapes.transpose() * shapes, shapes.transpose() * values);
  const Eigen::VectorXd smooth = shapes * weights;
  return {smooth.data(), smooth.data() + rows};
}

double square_of_difference(const std::vector<double>& x, const std::vector<double>& y) {
  double square = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) square += (x[n] - y[n]) * (x[n] - y[n]);
  return square / static_cast<double>(x.size());
}

// That the quick part of the channel says the same as the slow one: with it the blocks are better.
double borne_out(const Model& model, const Signals& signals, const Signals& smooth,
                 const Blocks& blocks) {
  FitOptions options;
  options.max_iterations = kTimeIterations;
  Model of_time = model;
  fit(of_time, smooth, blocks, options);
  const HeldOut by_time = held_out(of_time, smooth, blocks);
  const HeldOut by_channel = held_out(model, signals, blocks);
  if (!by_time.finite) return 1.0;
  const Comparison comparison = compared(by_time, by_channel);
  if (!(comparison.t > 0.0)) return 0.0;
  return 1.0 - 2.0 * statistics::t_above(comparison.t, static_cast<double>(blocks.count) - 1.0);
}

}  // namespace

double apart_from_time(const Model& model, std::size_t effect, const Signals& signals,
                       const Blocks& blocks) {
  double apart = 1.0;
  for (const std::string& channel : model.effects[effect].channels) {
    const Signal& signal = signals.at(channel);
    if (signals.is_input(signal.source)) continue;
    std::vector<double> smooth = smooth_of(signal.values, signals);
    const double quick = square_of_difference(signal.values, smooth);
    if (quick > kSlow * signal.deviation * signal.deviation) continue;
    apart = std::min(
        apart, borne_out(model, signals, signals.replaced(channel, std::move(smooth)), blocks));
  }
  return apart;
}

}  // namespace stillhand::diagnosis

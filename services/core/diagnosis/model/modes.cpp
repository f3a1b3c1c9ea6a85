// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/modes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace stillhand::diagnosis {
namespace {

// Column c holds `factor`, c samples later: the matrix of a multiplication by it.
void write_shifted(const std::vector<double>& factor, Eigen::Index first, Eigen::Index columns,
                   Eigen::MatrixXd& matrix) {
  for (Eigen::Index c = 0; c < columns; ++c) {
    for (std::size_t i = 0; i < factor.size(); ++i) {
      matrix(c + static_cast<Eigen::Index>(i), first + c) = factor[i];
    }
  }
}

}  // namespace

std::vector<double> mode_denominator(double frequency_hz, double damping_ratio, double rate_hz) {
  const double w = 2.0 * std::numbers::pi * frequency_hz / rate_hz;
  const double radius = std::exp(-damping_ratio * w);
  const double turn = w * std::sqrt(std::max(1.0 - damping_ratio * damping_ratio, 0.0));
  return {1.0, -2.0 * radius * std::cos(turn), radius * radius};
}

std::vector<double> denominator_with(const std::vector<std::complex<double>>& poles) {
  std::vector<std::complex<double>> all{1.0};
  for (const std::complex<double>& pole : poles) {
    all.emplace_back(0.0);
    for (std::size_t i = all.size(); i-- > 1;) all[i] -= pole * all[i - 1];
  }
  std::vector<double> result(all.size());
  std::ranges::transform(all, result.begin(), [](const auto& c) { return c.real(); });
  return result;
}

std::vector<SplitBody> split_modes(const Body& body, double rate_hz) {
  std::vector<SplitBody> splits;
  const std::size_t order = body.order();
  if (order < 3) return splits;
  const auto poles = signal::poles({1.0, body.denominator, body.denominator});
  for (std::size_t p = 0; p < poles.size(); ++p) {
    if (poles[p].imag() <= 0.0) continue;
    const double decay = -std::log(std::abs(poles[p]));
    const double turn = std::arg(poles[p]);
    const double w = std::hypot(decay, turn);
    SplitBody split{body, w * rate_hz / (2.0 * std::numbers::pi), decay / w, {}};
    const auto mode = mode_denominator(split.frequency_hz, split.damping_ratio, rate_hz);
    // A' by dividing the mode's poles out of A; what remains of the division is rounding.
    std::vector<double> left = body.denominator;
    split.rest.denominator.assign(order - 1, 0.0);
    for (std::size_t i = 0; i + 2 < left.size(); ++i) {
      split.rest.denominator[i] = left[i];
      for (std::size_t j = 0; j < mode.size(); ++j)
        left[i + j] -= split.rest.denominator[i] * mode[j];
    }
    // B = B' M + C A': order + 1 coefficients, order - 1 unknown in B', two in C.
    const auto size = static_cast<Eigen::Index>(order + 1);
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
    write_shifted(mode, 0, size - 2, matrix);
    write_shifted(split.rest.denominator, size - 2, 2, matrix);
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(matrix);
    if (!solver.isInvertible()) continue;  // a double pole
    for (std::size_t k = 0; k < body.numerators.size(); ++k) {
      const Eigen::VectorXd solution =
          solver.solve(Eigen::Map<const Eigen::VectorXd>(body.numerators[k].data(), size));
      split.rest.numerators[k].assign(solution.data(), solution.data() + size - 2);
      split.mode.push_back({solution[size - 2], solution[size - 1]});
    }
    splits.push_back(std::move(split));
  }
  return splits;
}

}  // namespace stillhand::diagnosis

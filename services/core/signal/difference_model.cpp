// SPDX-License-Identifier: Apache-2.0
#include "services/core/signal/difference_model.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "services/core/signal/decompositions.hpp"

namespace stillhand::signal {

bool well_formed(const DifferenceModel& model) noexcept {
  if (!(model.rate_hz > 0.0) || !std::isfinite(model.rate_hz)) return false;
  if (model.denominator.empty() || model.numerator.size() != model.denominator.size()) return false;
  if (model.denominator.front() != 1.0) return false;
  for (const double c : model.numerator) {
    if (!std::isfinite(c)) return false;
  }
  for (const double d : model.denominator) {
    if (!std::isfinite(d)) return false;
  }
  return true;
}

bool is_stable(const DifferenceModel& model) {
  std::vector<double> d = model.denominator;
  for (std::size_t m = d.size() - 1; m >= 1; --m) {
    const double reflection = d[m];
    // Written so that a NaN says "not stable".
    if (!(std::abs(reflection) < 1.0)) return false;
    const double norm = 1.0 / (1.0 - reflection * reflection);
    std::vector<double> lower(m);
    for (std::size_t i = 0; i < m; ++i) lower[i] = (d[i] - reflection * d[m - i]) * norm;
    d = std::move(lower);
  }
  return true;
}

std::vector<std::complex<double>> poles(const DifferenceModel& model) {
  const auto order = static_cast<Eigen::Index>(model.order());
  if (order == 0) return {};
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(order, order);
  for (Eigen::Index i = 0; i < order; ++i) {
    companion(0, i) = -model.denominator[static_cast<std::size_t>(i) + 1];
    if (i > 0) companion(i, i - 1) = 1.0;
  }
  const Eigen::VectorXcd values = eigenvalues(companion);
  return {values.begin(), values.end()};
}

std::complex<double> polynomial_at(const std::vector<double>& c, std::complex<double> x) noexcept {
  std::complex<double> sum = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * x + c[i];
  return sum;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> result(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) result[i + j] += a[i] * b[j];
  }
  return result;
}

std::complex<double> response_at(const DifferenceModel& model, double frequency_hz) noexcept {
  const double angle_rad = 2.0 * std::numbers::pi * frequency_hz / model.rate_hz;
  const std::complex<double> back(std::cos(angle_rad), -std::sin(angle_rad));
  return polynomial_at(model.numerator, back) / polynomial_at(model.denominator, back);
}

std::vector<double> simulated(const DifferenceModel& model,
                              const std::vector<double>& acceleration_m_s2) {
  const std::size_t order = model.order();
  std::vector<double> state(order + 1, 0.0);
  std::vector<double> force_n;
  force_n.reserve(acceleration_m_s2.size());
  for (const double a : acceleration_m_s2) {
    const double f = model.numerator[0] * a + state[0];
    for (std::size_t i = 1; i <= order; ++i) {
      state[i - 1] = model.numerator[i] * a - model.denominator[i] * f + state[i];
    }
    force_n.push_back(f);
  }
  return force_n;
}

}  // namespace stillhand::signal

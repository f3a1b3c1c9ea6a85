// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/polynomial.hpp"

#include <Eigen/Dense>

#include "services/core/signal/decompositions.hpp"

namespace stillhand::identification {

std::vector<std::complex<double>> roots(Polynomial polynomial) {
  while (!polynomial.empty() && polynomial.back() == 0.0) polynomial.pop_back();
  if (polynomial.size() < 2) return {};
  const auto degree = static_cast<Eigen::Index>(polynomial.size()) - 1;
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(degree, degree);
  for (Eigen::Index i = 0; i < degree; ++i) {
    companion(i, degree - 1) = -polynomial[static_cast<std::size_t>(i)] / polynomial.back();
    if (i > 0) companion(i, i - 1) = 1.0;
  }
  const Eigen::VectorXcd values = signal::eigenvalues(companion);
  return {values.begin(), values.end()};
}

Polynomial from_roots(const std::vector<std::complex<double>>& roots) {
  std::vector<std::complex<double>> c{1.0};
  for (const std::complex<double>& root : roots) {
    c.push_back(c.back());
    for (std::size_t i = c.size() - 2; i > 0; --i) c[i] = c[i - 1] - root * c[i];
    c[0] *= -root;
  }
  Polynomial real(c.size());
  for (std::size_t i = 0; i < c.size(); ++i) real[i] = c[i].real();
  return real;
}

}  // namespace stillhand::identification

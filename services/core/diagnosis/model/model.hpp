// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <string>
#include <vector>

#include "services/core/diagnosis/model/effect.hpp"

namespace stillhand::diagnosis {

/// The linear part, METHOD Eq. DG-1, for input k:
///
///   y_b(n) = sum_k sum_{i=0..p} b_k,i u_k(n-i) - sum_{j=1..p} a_j y_b(n-j)
struct Body {
  std::vector<std::vector<double>> numerators;  ///< [inputs][p + 1]
  std::vector<double> denominator{1.0};         ///< 1, a_1 .. a_p; alone 1: static
  double offset = 0.0;                          ///< [unit of the output]
  double largest_radius = 0.9999;               ///< [-] bound on every pole's radius
  double slowest_radius = 1.0;  ///< [-] bound on the radius of poles that turn less than least_turn
  double least_turn = 0.0;      ///< [rad] a sample; slower than anything that the input excites

  [[nodiscard]] std::size_t order() const noexcept { return denominator.size() - 1; }
};

/// A linear body and the effects that it lacks.
struct Model {
  double rate_hz = 0.0;
  std::vector<std::string> inputs;
  std::string output;
  std::string output_unit;
  Body body;
  std::vector<Effect> effects;
  double heldout_rmse = 0.0;  ///< [unit of the output] on samples that the fit has not seen; 0: not
                              ///< known
};

/// Number of fitted numbers.
std::size_t complexity(const Model& model) noexcept;

/// True when every number is finite and every pole of the body lies within largest_radius, and
/// within slowest_radius where it turns less than least_turn: the free response of a pole that
/// decays too slowly would fit a tone, and that of one below the excited band a drift.
bool is_stable(const Body& body);

/// True when a pole decays within more than half of the time that its bound allows: the bound may
/// hold it back, Eq. DG-66.
bool is_near_bound(const Body& body);

/// For each pole on its bound (its decay lasts for 0.99 of the time that is allowed, or more) how
/// its radius changes with the fitted numbers, in packed()'s order; a pair of poles counts once.
std::vector<Eigen::VectorXd> radii_on_bound(const Model& model);

/// The poles that is_stable() would refuse, mirrored into the unit circle, then drawn in.
void stabilise(Body& body);

/// The fitted numbers in one vector, in a basis in which they are well conditioned: polynomials in
/// q^-1 by powers of the difference D = 1 - q^-1, Eq. DG-8.  Order: offset, numerators,
/// denominator, then the coefficients and fitted parameters of each effect that is whole.
Eigen::VectorXd packed(const Model& model);
/// The reverse; parameters are kept within their bounds.
void unpack(const Eigen::VectorXd& numbers, Model& model);

/// sum_i c_i q^-i = sum_i d_i (1 - q^-1)^i, Eq. DG-8; its own inverse.
std::vector<double> difference_basis(const std::vector<double>& coefficients);

}  // namespace stillhand::diagnosis

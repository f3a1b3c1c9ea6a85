// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "services/core/diagnosis/fitting/blocks.hpp"

namespace stillhand::diagnosis {

/// A residual moved in time against the inputs, in a circle of the rows that weigh.
/// @param part  [-] of the circle
Eigen::VectorXd moved_in_time(const Eigen::VectorXd& residual, const std::vector<double>& weight,
                              double part, bool backwards);

/// Surrogate data, METHOD Eq. DG-93: noise with this residual's spectrum that nothing in the inputs
/// explains.  The even ones are turned backwards and moved in time, by a tenth of the record to
/// nine tenths; the odd ones have other phases.  Pure.
/// @return [samples x count]
Eigen::MatrixXd surrogates(const Eigen::VectorXd& residual, const std::vector<double>& weight,
                           std::size_t count);

/// So many say with p = 1 % that none of them reaches a value.
inline constexpr Eigen::Index kSurrogates = 99;
/// [-] A larger p is chance.
inline constexpr double kSurrogateSignificance = 0.01;
/// [-] p of a value, by how many of the surrogates reach it: (1 + reached)/(1 + count).
double surrogate_p(double value, const Eigen::ArrayXd& of_surrogates);

/// [-] of the squared error that columns explain, held out, Eq. DG-14.
struct SurrogateShares {
  double own = 0.0;           ///< of the residual itself
  Eigen::ArrayXd surrogates;  ///< of each surrogate of it
};

/// What columns next to a model explain of its residual and of kSurrogates surrogates of it.
class SurrogateGains {
 public:
  /// @param jacobian, residual, weight, blocks  of the model, as in Linearisation; stay until the
  /// last use
  SurrogateGains(const Eigen::MatrixXd& jacobian, const Eigen::VectorXd& residual,
                 const std::vector<double>& weight, const Blocks& blocks);

  /// @param more  [samples x columns] as in Screening::as_added()
  [[nodiscard]] SurrogateShares shares(const Eigen::MatrixXd& more) const;

 private:
  /// Sum over the blocks of each residual's squares, held out, next to `more` columns.
  [[nodiscard]] Eigen::ArrayXd held_out_squares(const Eigen::MatrixXd& more) const;

  const Eigen::MatrixXd& jacobian_;
  const std::vector<double>& weight_;
  const Blocks& blocks_;
  Eigen::MatrixXd residuals_;                  ///< itself, then the surrogates
  std::vector<Eigen::MatrixXd> own_products_;  ///< by block, of the model's columns with them
  Eigen::ArrayXd without_;                     ///< held_out_squares() of the model alone
};

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <functional>
#include <vector>

#include "services/core/diagnosis/model/evaluation.hpp"

namespace stillhand::diagnosis {

/// How exactly a recording determines the numbers of a model that was fitted to it, and whatever is
/// a function of them: the covariance of the joint fit under noise of the residual's own colour,
/// METHOD Eq. DG-70, and standard errors by the gradient, Eq. DG-71.
/// Linearised, and right as far as the model is: what the model lacks is no noise.  Pure.
/// Source: Ljung, System Identification, 2nd ed., 9.2 to 9.4.
class NumberErrors {
 public:
  /// @param model  fitted to the signals, which are not whitened
  /// @param line   of the model over them
  NumberErrors(const Model& model, const Linearisation& line, const Signals& signals);

  /// Standard error of number i of packed(); NaN where the samples do not determine it.
  [[nodiscard]] double of_number(std::size_t i) const;
  /// Of values that a model has, by central differences over its numbers; NaN as above.
  /// @param values  as many for every model of this structure
  [[nodiscard]] std::vector<double> of(
      const std::function<std::vector<double>(const Model&)>& values) const;

 private:
  [[nodiscard]] double along(const Eigen::VectorXd& gradient) const;

  Model model_;
  Eigen::VectorXd scale_;         // numbers of one column length
  Eigen::VectorXd step_;          // of the differences
  Eigen::MatrixXd covariance_;    // of the numbers over scale_, in the determined directions
  Eigen::MatrixXd undetermined_;  // the other directions, orthonormal
};

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "services/core/diagnosis/detection/periodic_excitation.hpp"

namespace stillhand::diagnosis {

/// What doesn't repeat while the excitation does.
struct Repeats {
  double rms = 0.0;                 ///< [unit of the output] Eq. DG-42
  double low = 0.0;                 ///< 95 %, chi-square
  double high = 0.0;                ///< 95 %
  double degrees_of_freedom = 0.0;  ///< [-] of that: coloured noise has fewer than samples
  std::size_t periods = 0;          ///< that were compared
  bool first_left_out = false;      ///< the first period differs from the others
};

/// Variance between the periods, the mean period removed; and the lines over all periods, from
/// which the detection lines are computed.
struct RepeatedResidual {
  Periodicity used;  ///< without a first period that differs
  Repeats repeats;
  std::vector<std::complex<double>> lines;  ///< 0 to half the samples used, Eq. DG-43
};

/// @param residual  weighted, as long as the signals
/// @param weight    samples that count; fewer than nine in ten of a periodic part: empty
std::optional<RepeatedResidual> repeated_residual(const Periodicity& periodicity,
                                                  const Eigen::VectorXd& residual,
                                                  const std::vector<double>& weight);

}  // namespace stillhand::diagnosis

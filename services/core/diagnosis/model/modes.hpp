// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {

using signal::product;

/// The poles of a mode as 1 + m_1 q^-1 + m_2 q^-2, by the matched z transform.
/// @param damping_ratio  [-] 0 to 1
std::vector<double> mode_denominator(double frequency_hz, double damping_ratio, double rate_hz);

/// The denominator with these poles, by powers of q^-1; complex ones come in pairs.
std::vector<double> denominator_with(const std::vector<std::complex<double>>& poles);

/// A body taken apart into one of its modes and the rest, Eq. DG-38, for input k:
///
///   B_k(q) / A(q) = B'_k(q) / A'(q) + C_k(q) / M(q),   A = A' M,  C_k = c_k,0 + c_k,1 q^-1
struct SplitBody {
  Body rest;                                ///< B', A', and everything else of the body
  double frequency_hz = 0.0;                ///< of M
  double damping_ratio = 0.0;               ///< [-] of M
  std::vector<std::array<double, 2>> mode;  ///< [inputs] c_k,0 and c_k,1
};

/// One split for every mode (pair of complex poles) of a body of at least order 3.
std::vector<SplitBody> split_modes(const Body& body, double rate_hz);

}  // namespace stillhand::diagnosis

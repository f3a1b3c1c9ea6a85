// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

namespace stillhand::identification {

/// Real polynomial by its coefficients, lowest power first: c_0 + c_1 x + ... + c_n x^n.
using Polynomial = std::vector<double>;

/// Roots, the eigenvalues of the companion matrix; for the poles of METHOD Eq. ID-10.  Leading
/// coefficients of exactly 0 are dropped.
std::vector<std::complex<double>> roots(Polynomial polynomial);

/// Monic polynomial with these roots, which come in conjugate pairs or are real; rounding's
/// imaginary part is dropped.
Polynomial from_roots(const std::vector<std::complex<double>>& roots);

}  // namespace stillhand::identification

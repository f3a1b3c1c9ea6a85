// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <vector>

namespace stillhand::diagnosis {

/// X(j) = sum_n x(n) exp(-2 pi i j n / N), j = 0 .. N/2, for any length: where N has a prime factor
/// above 31 by convolution with a chirp (Bluestein, IEEE Trans. Audio Electroacoust. 18(4), 1970),
/// so that no length costs many times what its neighbour does.  Pure.
std::vector<std::complex<double>> fourier_lines(const std::vector<double>& x);

}  // namespace stillhand::diagnosis

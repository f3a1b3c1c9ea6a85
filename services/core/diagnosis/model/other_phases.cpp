// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/other_phases.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace stillhand::diagnosis {

std::vector<double> other_phases(std::vector<double> x, signal::Gaussian draw) {
  const std::size_t count = x.size();
  x.resize(std::bit_ceil(std::max<std::size_t>(count, 2)), 0.0);
  std::vector<std::complex<double>> spectrum;
  Eigen::FFT<double> transform;
  transform.fwd(spectrum, x);
  const std::size_t size = spectrum.size();
  for (std::size_t k = 1; k < size / 2; ++k) {
    spectrum[k] *= std::polar(1.0, 2.0 * std::numbers::pi * draw.uniform());
    spectrum[size - k] = std::conj(spectrum[k]);
  }
  transform.inv(x, spectrum);
  // What was filled up with zeros is spread over all.
  const double louder = std::sqrt(static_cast<double>(x.size()) / static_cast<double>(count));
  x.resize(count);
  for (double& value : x) value *= louder;
  return x;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/fourier_lines.hpp"

#include <bit>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <unsupported/Eigen/FFT>

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

// Prime factors up to this one cost a plain transform less than the chirp's three.
constexpr std::size_t kSmooth = 31;

bool is_smooth(std::size_t count) {
  for (std::size_t factor = 2; factor <= kSmooth; ++factor) {
    while (count % factor == 0) count /= factor;
  }
  return count == 1;
}

}  // namespace

std::vector<Complex> fourier_lines(const std::vector<double>& x) {
  const std::size_t count = x.size();
  if (count <= 1) return {x.begin(), x.end()};  // Eigen's transform wants two
  if (is_smooth(count)) {
    Eigen::FFT<double> transform;
    const std::vector<Complex> whole(x.begin(), x.end());
    std::vector<Complex> lines;
    transform.fwd(lines, whole);
    lines.resize(count / 2 + 1);
    return lines;
  }
  // j n = (j^2 + n^2 - (j - n)^2) / 2; n^2 modulo 2 N in integers: no phase error builds up.
  std::vector<Complex> chirp(count);
  for (std::size_t n = 0; n < count; ++n) {
    const auto square = static_cast<double>(n * n % (2 * count));
    chirp[n] = std::polar(1.0, std::numbers::pi * square / static_cast<double>(count));
  }
  const std::size_t size = std::bit_ceil(2 * count - 1);
  std::vector<Complex> signal(size);
  std::vector<Complex> response(size);
  for (std::size_t n = 0; n < count; ++n) {
    signal[n] = x[n] * std::conj(chirp[n]);
    response[n] = chirp[n];
    if (n > 0) response[size - n] = chirp[n];
  }
  Eigen::FFT<double> transform;
  std::vector<Complex> left;
  std::vector<Complex> right;
  transform.fwd(left, signal);
  transform.fwd(right, response);
  for (std::size_t k = 0; k < size; ++k) left[k] *= right[k];
  transform.inv(signal, left);
  signal.resize(count / 2 + 1);
  for (std::size_t j = 0; j < signal.size(); ++j) signal[j] *= std::conj(chirp[j]);
  return signal;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <unsupported/Eigen/FFT>

namespace stillhand::motion {

/// Fourier transform (kissfft, Eigen's own backend, BSD) whose inverse is a plain sum of lines.
/// A trial transforms grids of one size many times: a thread keeps the tables of its last size.
/// @param size  of the grid
inline Eigen::FFT<double>& transform(std::size_t size) {
  thread_local std::size_t of_size = 0;
  thread_local Eigen::FFT<double> of_thread;
  if (size != of_size) {
    of_thread = Eigen::FFT<double>();
    of_thread.SetFlag(Eigen::FFT<double>::Unscaled);
    of_size = size;
  }
  return of_thread;
}

}  // namespace stillhand::motion

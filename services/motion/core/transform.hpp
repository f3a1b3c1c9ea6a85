// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <unsupported/Eigen/FFT>

namespace stillhand::motion {

/// Fourier transform (kissfft, Eigen's own backend, BSD) whose inverse is a plain sum of lines.
/// Every trial transforms grids of the same few sizes: a thread keeps their tables.
inline Eigen::FFT<double>& transform() {
  thread_local Eigen::FFT<double> of_thread = [] {
    Eigen::FFT<double> made;
    made.SetFlag(Eigen::FFT<double>::Unscaled);
    return made;
  }();
  return of_thread;
}

}  // namespace stillhand::motion

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace stillhand::diagnose {

/// Equal bins of a variable.
struct BinAxis {
  double low = 0.0;
  double high = 1.0;
  std::size_t count = 30;

  /// Index of the bin, or `count` for a value outside or not finite.
  [[nodiscard]] std::size_t bin_of(double x) const noexcept;
  [[nodiscard]] double centre(std::size_t bin) const noexcept;
};

/// Number of bins, 8 to `most`, that leaves each some 25 independent samples.
std::size_t bins_for(const std::vector<double>& weight, double correlation_samples,
                     std::size_t most);

/// Bins over all but the outermost 0.2 % at each end.
/// @param weight  samples that count
BinAxis axis_over(const std::vector<double>& x, const std::vector<double>& weight,
                  std::size_t count);

/// Means of y by bins of x; bins that hold fewer than five independent samples are left out.
struct BinnedMeans {
  std::vector<double> centre;
  std::vector<double> mean;
  std::vector<double> standard_error;
};

/// @param correlation_samples  how many samples count as one that is independent, at least 1
BinnedMeans binned_means(const BinAxis& axis, const std::vector<double>& x,
                         const std::vector<double>& y, const std::vector<double>& weight,
                         double correlation_samples);

/// [-] of y's variance that lies between the bins: 1 when y is a function of x.
double share_between_bins(const BinAxis& axis, const std::vector<double>& x,
                          const std::vector<double>& y, const std::vector<double>& weight);

}  // namespace stillhand::diagnose

// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/page/binning.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::diagnose {
namespace {

constexpr double kCutOff = 0.002;
constexpr double kFewestIndependent = 5.0;

struct Sums {
  double weight = 0.0;
  double sum = 0.0;
  double square = 0.0;
};

std::vector<Sums> sums_of(const BinAxis& axis, const std::vector<double>& x,
                          const std::vector<double>& y, const std::vector<double>& weight) {
  std::vector<Sums> sums(axis.count);
  for (std::size_t n = 0; n < x.size(); ++n) {
    const std::size_t bin = axis.bin_of(x[n]);
    if (bin == axis.count || !(weight[n] > 0.0)) continue;
    sums[bin].weight += 1.0;
    sums[bin].sum += y[n];
    sums[bin].square += y[n] * y[n];
  }
  return sums;
}

}  // namespace

std::size_t BinAxis::bin_of(double x) const noexcept {
  if (!(x >= low && x <= high)) return count;
  const auto bin = static_cast<std::size_t>((x - low) / (high - low) * static_cast<double>(count));
  return std::min(bin, count - 1);
}

double BinAxis::centre(std::size_t bin) const noexcept {
  return low + (high - low) * (static_cast<double>(bin) + 0.5) / static_cast<double>(count);
}

std::size_t bins_for(const std::vector<double>& weight, double correlation_samples,
                     std::size_t most) {
  constexpr std::size_t kFewest = 8;
  constexpr double kInEach = 25.0;
  const auto counted =
      static_cast<double>(std::ranges::count_if(weight, [](double each) { return each > 0.0; }));
  const double bins = counted / std::max(correlation_samples, 1.0) / kInEach;
  if (bins >= static_cast<double>(most)) return most;
  return std::max(static_cast<std::size_t>(bins), std::min(kFewest, most));
}

BinAxis axis_over(const std::vector<double>& x, const std::vector<double>& weight,
                  std::size_t count) {
  std::vector<double> sorted;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (weight[n] > 0.0 && std::isfinite(x[n])) sorted.push_back(x[n]);
  }
  if (sorted.empty()) return {0.0, 1.0, count};
  std::ranges::sort(sorted);
  const auto cut = static_cast<std::size_t>(kCutOff * static_cast<double>(sorted.size()));
  BinAxis axis{sorted[cut], sorted[sorted.size() - 1 - cut], count};
  if (!(axis.high > axis.low)) axis.high = axis.low + std::max(std::abs(axis.low), 1.0);
  return axis;
}

BinnedMeans binned_means(const BinAxis& axis, const std::vector<double>& x,
                         const std::vector<double>& y, const std::vector<double>& weight,
                         double correlation_samples) {
  BinnedMeans result;
  const std::vector<Sums> sums = sums_of(axis, x, y, weight);
  for (std::size_t b = 0; b < axis.count; ++b) {
    const double independent = sums[b].weight / std::max(correlation_samples, 1.0);
    if (independent < kFewestIndependent) continue;
    const double mean = sums[b].sum / sums[b].weight;
    const double variance = std::max(sums[b].square / sums[b].weight - mean * mean, 0.0);
    result.centre.push_back(axis.centre(b));
    result.mean.push_back(mean);
    result.standard_error.push_back(std::sqrt(variance / (independent - 1.0)));
  }
  return result;
}

double share_between_bins(const BinAxis& axis, const std::vector<double>& x,
                          const std::vector<double>& y, const std::vector<double>& weight) {
  Sums all;
  double between = 0.0;
  for (const Sums& bin : sums_of(axis, x, y, weight)) {
    if (bin.weight < 1.0) continue;
    all.weight += bin.weight;
    all.sum += bin.sum;
    all.square += bin.square;
    between += bin.sum * bin.sum / bin.weight;
  }
  if (all.weight < 1.0) return 0.0;
  const double mean_part = all.sum * all.sum / all.weight;
  const double total = all.square - mean_part;
  return total > 0.0 ? (between - mean_part) / total : 0.0;
}

}  // namespace stillhand::diagnose

// SPDX-License-Identifier: Apache-2.0
#include "services/core/statistics/signed_rank.hpp"

#include <algorithm>
#include <cmath>

#include "services/core/statistics/distributions.hpp"
#include "services/core/statistics/sample_check.hpp"

namespace stillhand::statistics {
namespace {

constexpr std::size_t kExactUpTo = 25;

// P(W >= w) for n distinct ranks: the number of subsets of {1 .. n} by their sum.
double exact_tail(std::size_t count, double rank_sum) {
  const std::size_t most = count * (count + 1) / 2;
  std::vector<double> subsets(most + 1, 0.0);
  subsets[0] = 1.0;
  for (std::size_t rank = 1; rank <= count; ++rank) {
    for (std::size_t sum = most; sum >= rank; --sum) subsets[sum] += subsets[sum - rank];
  }
  double tail = 0.0;
  for (auto sum = static_cast<std::size_t>(std::lround(rank_sum)); sum <= most; ++sum) {
    tail += subsets[sum];
  }
  return tail / std::ldexp(1.0, static_cast<int>(count));
}

}  // namespace

double signed_rank_p(const std::vector<double>& differences) {
  require_sample(differences, 1, "signed_rank.differences");
  std::vector<double> kept;
  std::ranges::copy_if(differences, std::back_inserter(kept), [](double d) { return d != 0.0; });
  if (kept.empty()) return 1.0;
  std::ranges::sort(kept, {}, [](double d) { return std::abs(d); });
  const auto count = static_cast<double>(kept.size());
  double rank_sum = 0.0;
  double tie_term = 0.0;
  for (std::size_t first = 0; first < kept.size();) {
    std::size_t end = first;
    while (end < kept.size() && std::abs(kept[end]) == std::abs(kept[first])) ++end;
    const double rank = 0.5 * static_cast<double>(first + 1 + end);
    const auto tied = static_cast<double>(end - first);
    tie_term += tied * (tied * tied - 1.0);
    for (std::size_t i = first; i < end; ++i) {
      if (kept[i] > 0.0) rank_sum += rank;
    }
    first = end;
  }
  if (kept.size() <= kExactUpTo && tie_term == 0.0) return exact_tail(kept.size(), rank_sum);
  const double mean = count * (count + 1.0) / 4.0;
  const double deviation =
      std::sqrt(count * (count + 1.0) * (2.0 * count + 1.0) / 24.0 - tie_term / 48.0);
  const double z = (rank_sum - mean - 0.5) / deviation;
  return normal_above(z);
}

double signed_rank_two_sided_p(const std::vector<double>& differences) {
  std::vector<double> negated = differences;
  for (double& d : negated) d = -d;
  return std::min(1.0, 2.0 * std::min(signed_rank_p(differences), signed_rank_p(negated)));
}

}  // namespace stillhand::statistics

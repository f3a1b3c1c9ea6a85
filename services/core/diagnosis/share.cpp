// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/share.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace stillhand::diagnosis {
namespace {

// Products of a group of samples: of the residual with the difference, of the difference with
// itself.
struct Products {
  double crossed = 0.0;
  double squared = 0.0;
  double residual = 0.0;  // squared
};

// The share s with which |r - s d| is |r| and a twentieth.
double harmless_in(const Products& part) {
  constexpr double kMostHarm = 1.05;
  if (!(part.squared > 0.0)) return HUGE_VAL;
  const double more = (kMostHarm * kMostHarm - 1.0) * part.residual;
  return (part.crossed + std::sqrt(part.crossed * part.crossed + more * part.squared)) /
         part.squared;
}

// Of sum crossed / sum squared, by how much each group's own crossed product misses it.
double variance_over(const std::vector<Products>& groups, const Products& all) {
  const double share = all.crossed / all.squared;
  double sum = 0.0;
  double count = 0.0;
  for (const Products& group : groups) {
    if (!(group.squared > 0.0)) continue;
    const double miss = group.crossed - share * group.squared;
    sum += miss * miss;
    count += 1.0;
  }
  if (count < 2.0) return share * share;  // one group says nothing of its own error
  return count / (count - 1.0) * sum / (all.squared * all.squared);
}

}  // namespace

double rounded_share(double share) {
  constexpr double kNear = 0.1;
  if (share < kNear) return 0.0;
  return share > 1.0 - kNear ? 1.0 : share;
}

double Share::earned() const {
  if (!(estimate > std_error)) return 0.0;
  const double ratio = std_error / estimate;
  return rounded_share(std::min({estimate * (1.0 - ratio * ratio), 1.0 - ratio * ratio, harmless}));
}

Share share_of(const Eigen::VectorXd& residual, const Eigen::VectorXd& difference,
               const Blocks& parts) {
  std::vector<Products> of_blocks(parts.count);
  std::vector<Products> of_parts(parts.folds);
  Products all;
  for (Eigen::Index n = 0; n < residual.size(); ++n) {
    const std::size_t block = static_cast<std::size_t>(n) / parts.length;
    const double crossed = residual[n] * difference[n];
    const double squared = difference[n] * difference[n];
    for (Products* each : {&of_blocks[block], &of_parts[parts.fold_of(block)], &all}) {
      each->crossed += crossed;
      each->squared += squared;
      each->residual += residual[n] * residual[n];
    }
  }
  if (!(all.squared > 0.0)) return {};
  const double variance = std::max(variance_over(of_blocks, all), variance_over(of_parts, all));
  Share share{.estimate = all.crossed / all.squared, .std_error = std::sqrt(variance)};
  for (const Products& part : of_parts) {
    share.harmless = std::min(share.harmless, harmless_in(part));
  }
  return share;
}

double slow_share(Eigen::VectorXd signal, const std::vector<Stretch>& stretches,
                  std::size_t period) {
  signal.array() -= signal.mean();
  const auto length = static_cast<Eigen::Index>(std::max<std::size_t>(period, 1));
  double slow = 0.0;
  for (const Stretch& stretch : stretches) {
    const auto first = static_cast<Eigen::Index>(stretch.first);
    const auto end = static_cast<Eigen::Index>(stretch.end);
    for (Eigen::Index n = first; n < end; ++n) {
      const Eigen::Index from = std::max(first, n - length / 2);
      const Eigen::Index to = std::min(end, from + length);
      slow += std::pow(signal.segment(from, to - from).mean(), 2);
    }
  }
  return slow / std::max(signal.squaredNorm(), 1e-300);
}

}  // namespace stillhand::diagnosis

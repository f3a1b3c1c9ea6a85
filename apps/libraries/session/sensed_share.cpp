// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/session/sensed_share.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>

#include "apps/libraries/session/jackknife.hpp"
#include "services/core/signal/spectrum.hpp"

namespace stillhand::session {
namespace {

using signal::CrossSpectra;

constexpr std::size_t kBlocks = kJackknifeBlocks;
constexpr double kLeast_s = 12.0;
constexpr double kMost_s = 8.0;       // of a segment
constexpr double kExcited = 0.01;     // of the largest density of the acceleration
constexpr std::size_t kSegments = 2;  // in a block, half overlapped: 1.5 lengths

/// Spectra of each block of a record.
std::vector<CrossSpectra> blocks_of(const SensedMotion& motion, double rate_hz) {
  const std::size_t length = motion.accel_m_s2.size() / kBlocks;
  const auto most = static_cast<std::size_t>(kMost_s * rate_hz);
  const std::size_t segment = std::min(most, 2 * length / (kSegments + 1)) / 2 * 2;
  std::vector<CrossSpectra> out;
  for (std::size_t b = 0; b < kBlocks; ++b) {
    const auto cut = [&](const std::vector<double>& all) {
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(b * length);
      return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(length));
    };
    out.push_back(
        signal::cross_spectra(cut(motion.accel_m_s2), cut(motion.theta_rad), rate_hz, segment));
  }
  return out;
}

/// Mean over the blocks but one; `left_out` beyond the last: over all.
CrossSpectra mean_without(const std::vector<CrossSpectra>& blocks, std::size_t left_out) {
  CrossSpectra mean = blocks.front();
  const std::size_t lines = mean.s_xx.size();
  mean.s_xx.assign(lines, 0.0);
  mean.s_yy.assign(lines, 0.0);
  mean.s_xy.assign(lines, {});
  mean.independent_averages = 0.0;
  double used = 0.0;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (b == left_out) continue;
    used += 1.0;
    mean.independent_averages += blocks[b].independent_averages;
    for (std::size_t k = 0; k < lines; ++k) {
      mean.s_xx[k] += blocks[b].s_xx[k];
      mean.s_yy[k] += blocks[b].s_yy[k];
      mean.s_xy[k] += blocks[b].s_xy[k];
    }
  }
  for (std::size_t k = 0; k < lines; ++k) {
    mean.s_xx[k] /= used;
    mean.s_yy[k] /= used;
    mean.s_xy[k] /= used;
  }
  return mean;
}

/// |H|^2 at a line, less what noise alone puts there on average.
double gain_squared(const CrossSpectra& spectra, std::size_t k) {
  const double square = std::norm(spectra.s_xy[k]) / (spectra.s_xx[k] * spectra.s_xx[k]);
  const double noise = spectra.s_yy[k] / spectra.s_xx[k] - square;
  return square - noise / (spectra.independent_averages - 1.0);
}

/// Mean square of the stick's coherent motion, had it had the acceleration of `like`.
double coherent_power(const CrossSpectra& spectra, const CrossSpectra& like) {
  const double most = *std::ranges::max_element(like.s_xx);
  double power = 0.0;
  for (std::size_t k = 0; k < like.s_xx.size(); ++k) {
    if (like.s_xx[k] < kExcited * most || spectra.s_xx[k] <= 0.0) continue;
    power += gain_squared(spectra, k) * like.s_xx[k];
  }
  return power;
}

}  // namespace

std::optional<SensedShare> sensed_share(const SensedMotion& moving, const SensedMotion& cancelled,
                                        double rate_hz) {
  for (const SensedMotion* motion : {&moving, &cancelled}) {
    const auto size = static_cast<double>(motion->accel_m_s2.size());
    const bool whole = motion->theta_rad.size() == motion->accel_m_s2.size();
    if (!whole || size < kLeast_s * rate_hz) return std::nullopt;
  }
  // Trials of two lengths are cut to the shorter one, so that both have the same lines.
  const std::size_t common = std::min(moving.accel_m_s2.size(), cancelled.accel_m_s2.size());
  const auto shortened = [&](SensedMotion motion) {
    motion.accel_m_s2.resize(common);
    motion.theta_rad.resize(common);
    return blocks_of(motion, rate_hz);
  };
  const std::vector<CrossSpectra> b = shortened(moving);
  const std::vector<CrossSpectra> c = shortened(cancelled);
  const CrossSpectra all_b = mean_without(b, kBlocks);
  const CrossSpectra all_c = mean_without(c, kBlocks);
  const double full = coherent_power(all_b, all_c);
  if (!(full > 0.0) || !std::isfinite(coherent_power(all_c, all_c))) return std::nullopt;
  const auto left = [&](const CrossSpectra& of_b, const CrossSpectra& of_c) {
    return std::sqrt(std::max(0.0, coherent_power(of_c, all_c)) /
                     std::max(1e-300, coherent_power(of_b, all_c)));
  };
  const double variance =
      jackknife_variance([&](std::size_t j) { return left(mean_without(b, j), all_c); }) +
      jackknife_variance([&](std::size_t j) { return left(all_b, mean_without(c, j)); });
  const double reach = jackknife_reach(variance);
  const double share = 1.0 - left(all_b, all_c);
  return SensedShare{share, share - reach, share + reach};
}

}  // namespace stillhand::session

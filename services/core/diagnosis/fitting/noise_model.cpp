// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/fitting/noise_model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace stillhand::diagnosis {
namespace {

constexpr std::size_t kLargestOrder = 24;
constexpr double kSamplesForNumber = 100.0;  // at least, for each number of the noise model
// Share of the residual's power that counts as white whatever the spectrum.  Below it the spectrum
// is often that of a filter in the laboratory's own chain, and not of the noise.
constexpr double kWhiteShare = 1e-2;
constexpr double kWhiteEnough = 0.9;  // variance one step ahead over variance

// Over the pairs that both count, lags 0 to `most`.
std::vector<double> autocovariance(const Eigen::VectorXd& residual, const Signals& signals,
                                   std::size_t most) {
  std::vector<double> sums(most + 1, 0.0);
  double count = 0.0;
  for (const Stretch& stretch : signals.stretches()) {
    for (std::size_t n = stretch.first; n < stretch.end; ++n) {
      const double now = residual[static_cast<Eigen::Index>(n)];
      count += signals.weight()[n];
      const std::size_t past = std::min(most, n - stretch.first);
      for (std::size_t k = 0; k <= past; ++k) {
        sums[k] += now * residual[static_cast<Eigen::Index>(n - k)];
      }
    }
  }
  for (double& sum : sums) sum /= std::max(count, 1.0);
  return sums;
}

// Taps, first 1, and what they leave of the variance.
struct NoiseModel {
  std::vector<double> taps;  // empty: a residual of zeros
  double share = 1.0;
};

NoiseModel noise_model(const Eigen::VectorXd& residual, const Signals& signals) {
  double samples = 0.0;
  for (const double weight : signals.weight()) samples += weight;
  const auto most = std::min(kLargestOrder, static_cast<std::size_t>(samples / kSamplesForNumber));
  std::vector<double> covariance = autocovariance(residual, signals, most);
  if (!(covariance[0] > 0.0)) return {};
  covariance[0] *= 1.0 + kWhiteShare;
  // Levinson: the model of order p from that of order p - 1.
  std::vector<double> taps{1.0};
  std::vector<double> best = taps;
  double variance = covariance[0];
  double least = std::numeric_limits<double>::infinity();
  double best_variance = variance;
  for (std::size_t p = 0;; ++p) {
    const double akaike = samples * std::log(variance) + 2.0 * static_cast<double>(p);
    if (akaike < least) {
      least = akaike;
      best = taps;
      best_variance = variance;
    }
    if (p == most) break;
    double sum = 0.0;
    for (std::size_t k = 0; k < taps.size(); ++k) sum += taps[k] * covariance[p + 1 - k];
    const double reflection = -sum / variance;
    std::vector<double> next(taps);
    next.push_back(0.0);
    for (std::size_t k = 0; k < taps.size(); ++k) next[p + 1 - k] += reflection * taps[k];
    taps = std::move(next);
    variance *= 1.0 - reflection * reflection;
  }
  return {std::move(best), best_variance / covariance[0]};
}

std::vector<double> scaled(NoiseModel model) {
  for (double& tap : model.taps) tap /= std::sqrt(model.share);
  return std::move(model.taps);
}

}  // namespace

std::vector<double> whitening_taps(const Eigen::VectorXd& residual, const Signals& signals) {
  NoiseModel model = noise_model(residual, signals);
  if (model.share > kWhiteEnough) return {};
  return scaled(std::move(model));
}

std::vector<double> noise_taps(const Eigen::VectorXd& residual, const Signals& signals) {
  return scaled(noise_model(residual, signals));
}

double correlation_samples(const Eigen::VectorXd& residual, double rate_hz) {
  constexpr double kLongestCorrelation_s = 10.0;
  constexpr double kUncorrelated = 0.05;  // a correlation below it ends the sum
  const double power = std::max(residual.squaredNorm(), 1e-300);
  const Eigen::Index count = residual.size();
  const auto longest =
      std::min(count / 4, static_cast<Eigen::Index>(kLongestCorrelation_s * rate_hz));
  double sum = 1.0;
  for (Eigen::Index lag = 1; lag <= longest; ++lag) {
    const double rho = residual.head(count - lag).dot(residual.tail(count - lag)) / power;
    if (rho < kUncorrelated) break;
    sum += 2.0 * rho;
  }
  return sum;
}

}  // namespace stillhand::diagnosis

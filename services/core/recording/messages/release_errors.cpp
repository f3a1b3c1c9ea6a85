// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/release_errors.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::recording {
namespace {

constexpr std::size_t kBuckets = 100'000;
constexpr std::int64_t kNsPerUs = 1000;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

}  // namespace

ReleaseErrors::ReleaseErrors() : counts_(kBuckets + 1, 0) {}

void ReleaseErrors::add(std::int64_t error_ns, std::int64_t since_start_ns) {
  const std::int64_t us = std::max<std::int64_t>(error_ns, 0) / kNsPerUs;
  ++counts_[std::min(static_cast<std::size_t>(us), kBuckets)];
  ++count_;
  max_ns_ = std::max(max_ns_, error_ns);
  const std::int64_t second = since_start_ns / kNsPerSecond;
  if (seconds_.empty() || seconds_.back().number != second) seconds_.push_back({second, 0.0, 0});
  seconds_.back().sum_us += static_cast<double>(error_ns) / static_cast<double>(kNsPerUs);
  ++seconds_.back().count;
}

std::int64_t ReleaseErrors::percentile_us(double share) const noexcept {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t below = 0;
  for (std::size_t us = 0; us < counts_.size(); ++us) {
    below += counts_[us];
    if (below >= wanted && below > 0) return static_cast<std::int64_t>(us) + 1;
  }
  return 0;
}

double ReleaseErrors::drift_us_s() const noexcept {
  if (seconds_.size() < 3) return 0.0;
  double n = 0, mean_t = 0, mean_e = 0;
  for (const Second& second : seconds_) {
    n += 1;
    mean_t += static_cast<double>(second.number);
    mean_e += second.sum_us / static_cast<double>(second.count);
  }
  mean_t /= n;
  mean_e /= n;
  double covariance = 0, variance = 0;
  for (const Second& second : seconds_) {
    const double t = static_cast<double>(second.number) - mean_t;
    covariance += t * (second.sum_us / static_cast<double>(second.count) - mean_e);
    variance += t * t;
  }
  return covariance / variance;
}

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/messages/release_errors.hpp"

#include <algorithm>
#include <cmath>

namespace stillhand::recording {
namespace {

constexpr std::size_t kBuckets = 100'000;
constexpr std::int64_t kNsPerUs = 1000;

}  // namespace

ReleaseErrors::ReleaseErrors() : counts_(kBuckets + 1, 0) {}

void ReleaseErrors::add(std::int64_t error_ns) noexcept {
  const std::int64_t us = std::max<std::int64_t>(error_ns, 0) / kNsPerUs;
  ++counts_[std::min(static_cast<std::size_t>(us), kBuckets)];
  ++count_;
  max_ns_ = std::max(max_ns_, error_ns);
}

std::int64_t ReleaseErrors::percentile_us(double share) const noexcept {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
  std::uint64_t below = 0;
  for (std::size_t us = 0; us < kBuckets; ++us) {
    below += counts_[us];
    if (below >= wanted && below > 0) return static_cast<std::int64_t>(us) + 1;
  }
  return max_us();
}

}  // namespace stillhand::recording

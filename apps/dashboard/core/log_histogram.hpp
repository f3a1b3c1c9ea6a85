// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "services/core/signal/log_bins.hpp"

namespace stillhand::dashboard {

/// Quantiles of times [ns]; all 0 without a time.
struct Spread {
  std::uint64_t count = 0;
  std::int64_t p50_ns = 0, p99_ns = 0, p999_ns = 0, max_ns = 0;
  bool operator==(const Spread&) const = default;
};

/// Counts of times in bins 1/32 octave wide, Eq. DB-1.  Up to kMost_ns a quantile is at most 1/32 =
/// 3.2 % too high and never too low; the largest value is exact.  A negative time (of clocks that
/// differ) counts as 0 and in negative().  Constant size, 9.5 kB; pure, no allocation.
class LogHistogram {
 public:
  static constexpr std::int64_t kMost_ns = (std::int64_t{1} << 41) - 1;  ///< [ns] 36 minutes

  void add(std::int64_t ns) noexcept {
    if (ns < 0) ++negative_;
    const std::int64_t value = std::max<std::int64_t>(ns, 0);
    ++bins_[Bins::bin_of(std::min(value, kMost_ns))];
    max_ns_ = std::max(max_ns_, value);
    ++count_;
  }

  void clear() noexcept { *this = {}; }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t negative() const noexcept { return negative_; }
  [[nodiscard]] std::int64_t max_ns() const noexcept { return max_ns_; }

  /// Upper edge of the bin that holds the value of rank ceil(share * count); 0 without values.
  [[nodiscard]] std::int64_t quantile_ns(double share) const noexcept {
    const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      seen += bins_[bin];
      if (seen > 0 && seen >= rank) return std::min(Bins::upper_edge(bin), max_ns_);
    }
    return 0;
  }

  /// Number of values in the bins that end at or below `edge_ns`.
  [[nodiscard]] std::uint64_t count_up_to(std::int64_t edge_ns) const noexcept {
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins && Bins::upper_edge(bin) <= edge_ns; ++bin) {
      seen += bins_[bin];
    }
    return seen;
  }

  [[nodiscard]] Spread spread() const noexcept {
    return {count_, quantile_ns(0.5), quantile_ns(0.99), quantile_ns(0.999), max_ns_};
  }

 private:
  using Bins = signal::LogBins<5>;                          // 32 bins an octave
  static constexpr std::size_t kBins = Bins::kLinear * 37;  // up to kMost_ns

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::uint64_t negative_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace stillhand::dashboard {

/// How times are spread [ns]; all 0 without any.
struct Spread {
  std::uint64_t count = 0;
  std::int64_t p50_ns = 0, p99_ns = 0, p999_ns = 0, max_ns = 0;
  bool operator==(const Spread&) const = default;
};

/// Counts of times in bins 1/32 octave wide, Eq. DB-1: a quantile is told at most 1/32 = 3.2 % too
/// high and never too low, up to kMost_ns; the largest value exactly.  What is negative (a clock is
/// off) counts as 0 and is told apart.  9.5 kB whatever comes in; pure, no allocation.
class LogHistogram {
 public:
  static constexpr std::int64_t kMost_ns = (std::int64_t{1} << 41) - 1;  ///< [ns] 36 minutes

  void add(std::int64_t ns) noexcept {
    if (ns < 0) ++negative_;
    const std::int64_t value = std::max<std::int64_t>(ns, 0);
    ++bins_[bin_of(value)];
    max_ns_ = std::max(max_ns_, value);
    ++count_;
  }

  void clear() noexcept { *this = {}; }

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  [[nodiscard]] std::uint64_t negative() const noexcept { return negative_; }
  [[nodiscard]] std::int64_t max_ns() const noexcept { return max_ns_; }

  /// Upper edge of the bin that holds the value of rank ceil(share * count), 0 without values.
  [[nodiscard]] std::int64_t quantile_ns(double share) const noexcept {
    const auto rank = static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins; ++bin) {
      seen += bins_[bin];
      if (seen > 0 && seen >= rank) return std::min(upper_edge_ns(bin), max_ns_);
    }
    return 0;
  }

  /// How many are in the bins that end at or below `edge_ns`.
  [[nodiscard]] std::uint64_t count_up_to(std::int64_t edge_ns) const noexcept {
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < kBins && upper_edge_ns(bin) <= edge_ns; ++bin) {
      seen += bins_[bin];
    }
    return seen;
  }

  [[nodiscard]] Spread spread() const noexcept {
    return {count_, quantile_ns(0.5), quantile_ns(0.99), quantile_ns(0.999), max_ns_};
  }

 private:
  static constexpr int kLinearBits = 5;  // 32 bins an octave
  static constexpr std::size_t kLinear = std::size_t{1} << kLinearBits;
  static constexpr std::size_t kBins = kLinear * 37;  // up to kMost_ns

  static std::size_t bin_of(std::int64_t ns) noexcept {
    const auto value = static_cast<std::uint64_t>(std::min(ns, kMost_ns));
    if (value < kLinear) return value;
    const auto octave = static_cast<std::size_t>(std::bit_width(value)) - kLinearBits - 1;
    return kLinear * octave + (value >> octave);
  }
  static std::int64_t upper_edge_ns(std::size_t bin) noexcept {
    if (bin < kLinear) return static_cast<std::int64_t>(bin);
    const std::size_t octave = bin / kLinear - 1;
    return static_cast<std::int64_t>(((bin - kLinear * octave + 1) << octave) - 1);
  }

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  std::uint64_t negative_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace stillhand::dashboard

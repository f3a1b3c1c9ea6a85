// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "services/core/contract/tick.hpp"
#include "services/core/signal/log_bins.hpp"

namespace stillhand::signal {

/// Supervises one periodic topic from tick numbers and stamps, in microseconds: DDS 2.9.1 counts
/// deadlines in whole milliseconds, which is too coarse for a 1 ms cycle.  A sample is a cycle miss
/// when it arrives more than `tolerance_us` after its due time, one period after the sample before
/// it (Eq. SG-15: interval > period + tolerance).  Pure: the caller brings the
/// time.  No allocation; one thread.
class CycleMonitor {
 public:
  struct Config {
    std::int64_t period_us = 1000;
    std::int64_t tolerance_us = 1000;  ///< one further period: what the 16-deep reader absorbs
  };
  /// What the newest sample showed.
  struct Verdict {
    std::int64_t lost = 0;        ///< [ticks] missing just before this sample
    std::int64_t late_by_us = 0;  ///< [us] beyond period and tolerance, 0 when in time
  };

  CycleMonitor() = default;
  explicit CycleMonitor(Config config) : config_(config) {}

  /// @param tick     sample's tick; one not newer than the last is ignored
  /// @param sent_ns  writer's stamp [ns]  @param arrived_ns  reader's clock [ns]
  Verdict step(Tick tick, std::int64_t sent_ns, std::int64_t arrived_ns) noexcept {
    Verdict verdict;
    count_latency((arrived_ns - sent_ns) / 1000);
    if (samples_ > 0 && tick > last_tick_) {
      verdict.lost = tick - last_tick_ - 1;
      lost_ += verdict.lost;
      const std::int64_t interval_us = (arrived_ns - last_arrival_ns_) / 1000;
      worst_interval_us_ = std::max(worst_interval_us_, interval_us);
      const std::int64_t late_us = interval_us - config_.period_us - config_.tolerance_us;
      if (late_us > 0) {
        verdict.late_by_us = late_us;
        ++misses_;
      }
    }
    if (samples_ == 0 || tick > last_tick_) {
      last_tick_ = tick;
      last_arrival_ns_ = arrived_ns;
    }
    ++samples_;
    return verdict;
  }

  [[nodiscard]] std::int64_t period_us() const noexcept { return config_.period_us; }
  [[nodiscard]] std::int64_t samples() const noexcept { return samples_; }
  [[nodiscard]] std::int64_t lost() const noexcept { return lost_; }
  [[nodiscard]] std::int64_t misses() const noexcept { return misses_; }
  [[nodiscard]] std::int64_t worst_interval_us() const noexcept { return worst_interval_us_; }
  [[nodiscard]] std::int64_t max_latency_us() const noexcept { return max_latency_us_; }

  /// Upper edge of the bin that holds the given share of the latencies [us]; bins are 1/8 octave
  /// wide, so the answer is at most 12.5 % high.
  [[nodiscard]] std::int64_t latency_us(double share) const noexcept {
    const auto wanted = static_cast<std::int64_t>(share * static_cast<double>(samples_));
    std::int64_t seen = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      seen += bins_[bin];
      if (seen > wanted) return std::min(Bins::upper_edge(bin), max_latency_us_);
    }
    return max_latency_us_;
  }

 private:
  using Bins = LogBins<3>;

  void count_latency(std::int64_t us) noexcept {
    ++bins_[std::min(Bins::bin_of(std::max<std::int64_t>(us, 0)), kBins - 1)];
    max_latency_us_ = std::max(max_latency_us_, us);
  }

  static constexpr std::size_t kBins = Bins::kLinear * 24;

  Config config_;
  std::int64_t samples_ = 0;
  std::int64_t lost_ = 0;
  std::int64_t misses_ = 0;
  std::int64_t worst_interval_us_ = 0;
  std::int64_t max_latency_us_ = 0;
  Tick last_tick_ = 0;
  std::int64_t last_arrival_ns_ = 0;
  std::array<std::int64_t, kBins> bins_{};
};

}  // namespace stillhand::signal

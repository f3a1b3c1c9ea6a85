// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::dashboard {

/// One end of a topic as the process that holds it counts it; counts only grow while it lives.
struct EndCounts {
  std::uint32_t matched = 0;  ///< endpoints at the other side
  std::uint64_t samples = 0;
  std::uint64_t lost_ticks = 0;
  std::uint64_t cycle_misses = 0;     ///< its own supervision, microseconds
  std::uint64_t deadline_misses = 0;  ///< DDS's, and silence that a reader found
  double worst_interval_us = 0.0;
  double latency_p99_us = 0.0;
};

/// When a count was seen to grow: the first and the newest time, 0 never.
struct Growth {
  std::int64_t first_at_ns = 0, last_at_ns = 0;

  void note(bool grew, std::int64_t at_ns) noexcept {
    if (!grew) return;
    if (first_at_ns == 0) first_at_ns = at_ns;
    last_at_ns = at_ns;
  }
};

/// An edge of the graph: one end of a topic, and the time since when it is late or loses samples.
/// Counts from before the first report have no time.  Pure; one thread.
class EdgeHealth {
 public:
  void step(const EndCounts& counts, std::int64_t at_ns) noexcept {
    const bool again = counts.samples < counts_.samples;  // another process of that name
    if (again) *this = {};
    if (known_) {
      late_.note(counts.cycle_misses > counts_.cycle_misses, at_ns);
      missed_.note(counts.deadline_misses > counts_.deadline_misses, at_ns);
      lost_.note(counts.lost_ticks > counts_.lost_ticks, at_ns);
    }
    counts_ = counts;
    known_ = true;
  }

  [[nodiscard]] const EndCounts& counts() const noexcept { return counts_; }
  /// By its own supervision.
  [[nodiscard]] const Growth& late() const noexcept { return late_; }
  /// By DDS's.
  [[nodiscard]] const Growth& missed() const noexcept { return missed_; }
  [[nodiscard]] const Growth& lost() const noexcept { return lost_; }

 private:
  EndCounts counts_;
  Growth late_, missed_, lost_;
  bool known_ = false;
};

}  // namespace stillhand::dashboard

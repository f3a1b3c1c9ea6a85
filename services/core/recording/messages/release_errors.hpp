// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace stillhand::recording {

/// Release errors of a replay: time of the write minus due time.  A histogram counts them in steps
/// of 1 us up to 0.1 s.  Pure; one thread; add() does not allocate.
class ReleaseErrors {
 public:
  ReleaseErrors();

  /// @param error_ns  positive: late
  void add(std::int64_t error_ns) noexcept;

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Smallest whole microsecond above at least this share (0 to 1) of the errors; the largest error
  /// where that is above 0.1 s.
  [[nodiscard]] std::int64_t percentile_us(double share) const noexcept;
  [[nodiscard]] std::int64_t max_us() const noexcept { return max_ns_ / 1000; }

 private:
  std::vector<std::uint64_t> counts_;
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace stillhand::recording

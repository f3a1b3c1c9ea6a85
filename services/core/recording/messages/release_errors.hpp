// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace stillhand::recording {

/// Release errors of a replay: time of the write minus due time.  A histogram counts them in steps
/// of 1 us up to 0.1 s.  The drift is the slope of the least-squares line through the mean error of
/// each second.  Source: README Eq. RC-14.  Pure; one thread; allocates once a second.
class ReleaseErrors {
 public:
  ReleaseErrors();

  /// @param error_ns  positive: late  @param since_start_ns  time since the start of the replay
  void add(std::int64_t error_ns, std::int64_t since_start_ns);

  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }
  /// Smallest whole microsecond above at least this share (0 to 1) of the errors.
  [[nodiscard]] std::int64_t percentile_us(double share) const noexcept;
  [[nodiscard]] std::int64_t max_us() const noexcept { return max_ns_ / 1000; }
  /// [us/s] slope of the error; 0 with less than three seconds.
  [[nodiscard]] double drift_us_s() const noexcept;

 private:
  struct Second {
    std::int64_t number;
    double sum_us;
    std::uint64_t count;
  };
  std::vector<std::uint64_t> counts_;
  std::vector<Second> seconds_;
  std::uint64_t count_ = 0;
  std::int64_t max_ns_ = 0;
};

}  // namespace stillhand::recording

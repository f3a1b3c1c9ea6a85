// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace stillhand::dashboard {

/// Limits requests: those of a person pass, those of a program at most kMostPerSecond.  Pure: time
/// enters with each call; one thread.
class RequestRate {
 public:
  static constexpr std::size_t kMostPerSecond = 10;

  /// @param now_ns  [ns] positive, of a clock that never goes back
  /// @return it may go on: fewer than kMostPerSecond did within the second before
  bool take(std::int64_t now_ns) noexcept {
    std::int64_t& oldest_ns = taken_ns_[next_];
    if (oldest_ns != 0 && now_ns - oldest_ns < kSecond_ns) return false;
    oldest_ns = now_ns;
    next_ = (next_ + 1) % kMostPerSecond;
    return true;
  }

 private:
  static constexpr std::int64_t kSecond_ns = 1'000'000'000;

  std::array<std::int64_t, kMostPerSecond> taken_ns_{};  // 0: not yet
  std::size_t next_ = 0;
};

}  // namespace stillhand::dashboard

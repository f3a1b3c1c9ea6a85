// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace stillhand::runtime {

/// Newest value from one thread to another: wait-free on both sides, never torn (triple buffer).
/// One writer thread, one reader thread.  T is copied; keep it plain.
template <typename T>
class LatestValue {
 public:
  /// Writer thread: makes `value` the newest.
  void store(const T& value) noexcept {
    slots_[back_] = value;
    back_ = middle_.exchange(back_ | kFresh, std::memory_order_acq_rel) & kIndex;
  }

  /// Reader thread: the newest value, or the one before it again when nothing new came; T{} at
  /// first.
  const T& load() noexcept {
    if ((middle_.load(std::memory_order_relaxed) & kFresh) != 0) {
      front_ = middle_.exchange(front_, std::memory_order_acq_rel) & kIndex;
    }
    return slots_[front_];
  }

 private:
  static constexpr std::uint32_t kIndex = 3;
  static constexpr std::uint32_t kFresh = 4;

  std::array<T, 3> slots_{};
  std::uint32_t back_ = 0;                // writer's own
  std::atomic<std::uint32_t> middle_{1};  // handed over
  std::uint32_t front_ = 2;               // reader's own
};

}  // namespace stillhand::runtime

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace stillhand::dashboard {

enum class Level : std::uint8_t { kHealthy, kWarning, kCritical };

/// From which value on, both included; warning <= critical.
struct Threshold {
  double warning = 0.0;
  double critical = 0.0;

  [[nodiscard]] Level level_of(double value) const noexcept {
    if (value >= critical) return Level::kCritical;
    return value >= warning ? Level::kWarning : Level::kHealthy;
  }
};

/// An alarm that stays until it is acknowledged (ISA-18.2).  A value beyond a threshold raises it;
/// it holds its worst level until it is acknowledged *and* the value is back.  An acknowledged
/// alarm that gets worse or is raised again must be acknowledged again.  Pure; one thread.
class Alarm {
 public:
  explicit Alarm(Threshold threshold) : threshold_(threshold) {}

  void step(double value, std::int64_t now_ns) noexcept {
    const Level before = active_;
    active_ = threshold_.level_of(value);
    if (active_ == Level::kHealthy) {
      if (acknowledged_) forget();
      return;
    }
    if (held_ == Level::kHealthy) since_ns_ = now_ns;
    if (before == Level::kHealthy) ++count_;
    if (active_ > held_) {
      held_ = active_;
      acknowledged_ = false;
    }
    worst_ = std::max(worst_, value);
    last_ns_ = now_ns;
  }

  void acknowledge() noexcept {
    acknowledged_ = true;
    if (active_ == Level::kHealthy) {
      forget();
    } else {
      held_ = active_;
    }
  }

  /// The level to show: the worst since the last acknowledgement.
  [[nodiscard]] Level level() const noexcept { return held_; }
  [[nodiscard]] bool active() const noexcept { return active_ != Level::kHealthy; }
  [[nodiscard]] bool acknowledged() const noexcept { return acknowledged_; }
  [[nodiscard]] double worst() const noexcept { return worst_; }
  [[nodiscard]] std::int64_t since_ns() const noexcept { return since_ns_; }
  [[nodiscard]] std::int64_t last_ns() const noexcept { return last_ns_; }
  /// How often it was raised since it was acknowledged.
  [[nodiscard]] std::uint64_t count() const noexcept { return count_; }

 private:
  void forget() noexcept {
    held_ = Level::kHealthy;
    acknowledged_ = false;
    worst_ = 0.0;
    since_ns_ = last_ns_ = 0;
    count_ = 0;
  }

  Threshold threshold_;
  Level active_ = Level::kHealthy;
  Level held_ = Level::kHealthy;
  bool acknowledged_ = false;
  double worst_ = 0.0;
  std::int64_t since_ns_ = 0, last_ns_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace stillhand::dashboard

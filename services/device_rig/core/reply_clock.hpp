// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace stillhand::device_rig {

/// Judges by the drive's millisecond counter whether a reply is as young as it looks, README
/// Eq. DR-10.  A reply that was held up on its way, or that is sent again and again, falls behind
/// the host's clock; a counter that goes back, runs ahead, or jumps and runs on is a drive that
/// started again.
/// Pure; one thread.
class ReplyClock {
 public:
  enum class Verdict : std::uint8_t { kYoung, kOld, kRestarted };

  /// @param counter  of 16 bit, in the reply  @param now_ms  host's clock when the reply was read
  Verdict step(int counter, double now_ms) noexcept {
    const double step_ms = static_cast<std::int16_t>(counter - last_counter_);
    const double elapsed_ms = now_ms - last_ms_;
    last_counter_ = counter;
    last_ms_ = now_ms;
    if (!begun_) {
      begun_ = true;
      return Verdict::kYoung;
    }
    // The counter wraps after 65 s: a longer silence hides any number of turns.
    if (elapsed_ms > kUnambiguous_ms) return restart();
    behind_ms_ += elapsed_ms - step_ms;
    // Replies come in their order: no delay makes a counter go back, or run ahead of the host.
    if (step_ms < -kOrder_ms || behind_ms_ < -kMost_ms) return restart();
    if (std::abs(behind_ms_) <= kMost_ms) {
      behind_ms_ -= kForget * behind_ms_;
      outside_ = false;
      return Verdict::kYoung;
    }
    return outside(now_ms);
  }
  /// Forgets everything: the next reply counts as young.
  void clear() noexcept { *this = {}; }

 private:
  static constexpr double kMost_ms = 20.0;  ///< behind or ahead, of a young reply
  static constexpr double kOrder_ms = 1.0;
  /// Share of the difference that a reply forgets: two clocks that differ by 1 % stand 10 ms apart
  /// at 1 kHz.
  static constexpr double kForget = 1e-3;
  static constexpr double kUnambiguous_ms = 30'000.0;
  static constexpr double kSteady_ms = 10.0;   ///< a counter that runs on keeps its difference
  static constexpr double kSettle_ms = 200.0;  ///< for so long

  Verdict restart() noexcept {
    behind_ms_ = 0.0;
    outside_ = false;
    return Verdict::kRestarted;
  }
  Verdict outside(double now_ms) noexcept {
    if (!outside_ || std::abs(behind_ms_ - steady_ms_) > kSteady_ms) {
      outside_ = true;
      steady_ms_ = behind_ms_;
      since_ms_ = now_ms;
    }
    return now_ms - since_ms_ >= kSettle_ms ? restart() : Verdict::kOld;
  }

  bool begun_ = false;
  int last_counter_ = 0;
  double last_ms_ = 0.0;
  double behind_ms_ = 0.0;
  bool outside_ = false;
  double steady_ms_ = 0.0;
  double since_ms_ = 0.0;
};

}  // namespace stillhand::device_rig

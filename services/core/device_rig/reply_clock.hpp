// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace stillhand::device_rig {

/// Judges by the drive's millisecond counter whether a reply is as young as it looks, METHOD
/// Eq. DR-10.  A reply that was held up on its way, or that is sent again and again, falls behind
/// the host's clock; a counter that goes back, runs ahead, or jumps and runs on is a drive that
/// started again.  A stream whose samples count the time gives a limit of the drift: a reader that
/// carries less than comes looks like a slow clock.
/// Pure; one thread.
class ReplyClock {
 public:
  enum class Verdict : std::uint8_t {
    kYoung,
    kOld,
    kRestarted,
    kDrifted,  ///< young so far: throw away what waits, and clear()
    kTooSlow   ///< old for 200 ms: slower than any clock, however often what waits is thrown away
  };

  /// Largest drift of a stream, which empties its buffers and begins again [ms].
  static constexpr double kStreamDrift_ms = 20.0;

  /// @param most_drift_ms  that is forgiven until clear(); a drive's replies wait for no reader
  explicit ReplyClock(double most_drift_ms = std::numeric_limits<double>::infinity()) noexcept
      : most_drift_ms_(most_drift_ms) {}

  /// @param counter  of 16 bit, in the reply  @param now_ms  host's clock when the reply was read
  Verdict step(int counter, double now_ms) noexcept {
    const double step_ms = static_cast<std::int16_t>(counter - last_counter_);
    const double elapsed_ms = now_ms - last_ms_;
    last_counter_ = counter;
    last_ms_ = now_ms;
    if (now_ms < slow_until_ms_) return Verdict::kTooSlow;
    if (!begun_) {
      begun_ = true;
      begun_ms_ = now_ms;
      return Verdict::kYoung;
    }
    // The counter wraps after 65 s: a longer silence hides any number of turns.
    if (elapsed_ms > kUnambiguous_ms) return restart();
    behind_ms_ += elapsed_ms - step_ms;
    // Replies come in their order: no delay makes a counter go back, or run ahead of the host.
    if (step_ms < -kOrder_ms || behind_ms_ < -kMost_ms) return restart();
    if (std::abs(behind_ms_) > kMost_ms) {
      return stream() ? late(elapsed_ms - step_ms, now_ms) : outside(now_ms);
    }
    outside_ = false;
    return forgive(elapsed_ms, now_ms);
  }
  /// Forgets everything but how often it drifted: the next reply counts as young.
  void clear() noexcept {
    ReplyClock next(most_drift_ms_);
    next.quick_drifts_ = quick_drifts_;
    next.slow_until_ms_ = slow_until_ms_;
    *this = next;
  }

 private:
  static constexpr double kMost_ms = 20.0;  ///< behind or ahead, of a young reply
  static constexpr double kOrder_ms = 1.0;
  /// The difference is forgotten with this time constant, whatever the rate of the replies: two
  /// clocks that differ by 1 % stand 10 ms apart.
  static constexpr double kForget_ms = 1000.0;
  /// A crystal is within 100 ppm, an oscillator without one within 1 %: more is no clock.
  static constexpr double kTolerance = 0.01;
  static constexpr double kUnambiguous_ms = 30'000.0;
  static constexpr double kSteady_ms = 10.0;   ///< a counter that runs on keeps its difference
  static constexpr double kSettle_ms = 200.0;  ///< for so long
  /// A clock at the tolerance e drifts by e (t - T (1 - exp(-t/T))) = 20 ms in t = 2.95 s, with
  /// T = 1 s; a single quick drift may be a busy host.
  static constexpr double kQuick_ms = 2900.0;
  static constexpr int kMostQuick = 3;
  static constexpr double kJump_ms = 5.0;  ///< a reader that is too slow falls behind step by step
  static constexpr double kSlow_ms = 200.0;  ///< ends a trial

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
  // The counter of a stream does not start by itself: it stays old until clear().
  Verdict late(double grown_ms, double now_ms) noexcept {
    const bool first = !outside_;
    outside_ = true;
    // A host that stood still is no slow reader.
    const bool crept = first && grown_ms < kJump_ms;
    return crept && too_slow(true, now_ms) ? Verdict::kTooSlow : Verdict::kOld;
  }
  [[nodiscard]] bool stream() const noexcept { return std::isfinite(most_drift_ms_); }
  bool too_slow(bool behind, double now_ms) noexcept {
    const bool quick = behind && now_ms - begun_ms_ < kQuick_ms;
    quick_drifts_ = quick ? quick_drifts_ + 1 : 0;
    if (quick_drifts_ < kMostQuick) return false;
    quick_drifts_ = 0;
    slow_until_ms_ = now_ms + kSlow_ms;
    begun_ = false;
    return true;
  }
  Verdict forgive(double elapsed_ms, double now_ms) noexcept {
    const double most_ms = kTolerance * std::max(elapsed_ms, 0.0);
    const double forgiven_ms = std::clamp(behind_ms_ * elapsed_ms / kForget_ms, -most_ms, most_ms);
    behind_ms_ -= forgiven_ms;
    drift_ms_ += forgiven_ms;
    if (std::abs(drift_ms_) <= most_drift_ms_) return Verdict::kYoung;
    // A counter that is ahead is no reader that lags.
    return too_slow(drift_ms_ > 0.0, now_ms) ? Verdict::kTooSlow : Verdict::kDrifted;
  }

  double most_drift_ms_;
  bool begun_ = false;
  double begun_ms_ = 0.0;
  int last_counter_ = 0;
  double last_ms_ = 0.0;
  double behind_ms_ = 0.0;
  double drift_ms_ = 0.0;  ///< what was forgiven since it began
  int quick_drifts_ = 0;   ///< in a row
  double slow_until_ms_ = -std::numeric_limits<double>::infinity();
  bool outside_ = false;
  double steady_ms_ = 0.0;
  double since_ms_ = 0.0;
};

}  // namespace stillhand::device_rig

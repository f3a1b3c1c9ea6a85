// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "services/core/cancellation/explained_motion.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/statistics/change_chart.hpp"

namespace stillhand::cancellation {

/// Watches while the motor cancels whether the model goes on to hold, METHOD Eq. CC-20 to CC-22.
///
/// What counts is the response of the hand to the predicted force, its gain and phase, without the
/// motor's own part: what a hand does by itself, and involuntary forces, are no part of it but
/// noise.  Its value in the first blocks is what the model is, be it good or not; a lasting
/// difference from it is a change.  Slower ones than some minutes are learnt along.
/// One thread.  Pure; step() neither allocates nor throws.
class ModelWatch {
 public:
  /// One tick.
  struct Input {
    Tick tick;
    std::int32_t model;  ///< number of the model in use; another one is learnt from its beginning
    bool acts;           ///< the motor cancels, in the measured part of a trial
    double predicted_n;  ///< f^
    double taken_n;      ///< what the motor takes away of it
    double theta_rad;    ///< stick
  };
  /// The model no longer holds.
  struct Change {
    Tick since;    ///< first tick of the block with which it began, as estimated
    double share;  ///< [-] of the predicted force, by which the force at the hand is another one
  };

  /// @param false_alarms_h  [1/h] of cancelling, above 0
  /// @param hand            P of CC-10
  explicit ModelWatch(double false_alarms_h, const HandCompliance& hand = kAverageHand);

  /// The change, once, at the tick that shows it; the watch then learns what is from there on.
  std::optional<Change> step(const Input& input) noexcept;

 private:
  /// Forgets the motion: what comes settles first.
  void interrupt() noexcept;
  void begin_block() noexcept;
  void add(const ExplainedMotion::Pair& r, double e) noexcept;
  std::optional<Change> end_block(Tick tick) noexcept;

  ExplainedMotion predicted_;
  ExplainedMotion taken_;
  statistics::ChangeChart chart_;
  Tick last_tick_ = 0;
  std::int32_t model_ = -1;
  std::int64_t settle_left_ = 0;
  std::int64_t collected_ = 0;  ///< ticks of this block
  std::array<double, 3> rr_{};  ///< sums of r_0 r_0, r_0 r_1, r_1 r_1
  std::array<double, 2> re_{};  ///< of r e
  std::int64_t blocks_ = 0;
  /// First ticks of the newest blocks, at their number % size.
  std::array<Tick, statistics::ChangeChart::kRemembered> began_{};
};

}  // namespace stillhand::cancellation

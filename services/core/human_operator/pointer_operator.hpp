// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/contract/trial.hpp"
#include "services/core/human_operator/arm_feel.hpp"
#include "services/core/human_operator/operator_io.hpp"
#include "services/core/signal/force_envelope.hpp"
#include "services/core/signal/second_order_lag.hpp"

namespace stillhand::human_operator {

/// State of a person's pointer at one tick.
struct PointerInput {
  Tick tick;
  double pointer_m;  ///< newest position on the screen, positive right of its centre; NaN: none yet
  Tick pointer_age_ticks;  ///< since that position was read
  bool linked;             ///< the display that reads the pointer is alive
  bool active;             ///< a tracking trial runs and its samples arrive
};

/// A person replaces the simulated subject: the pointer on the screen moves a virtual arm:
///   x = muscle(pointer / 6),   f_t = B x' + K x
/// An arm of stiffness K and damping B with the rest position x pulls the stick at x_j with
/// K (x - x_j) + B (x' - x_j').  The passive body on the stick already contains the part with x_j.
/// A pointer older than `stale_age_ticks` keeps its position and is flagged kInputStale, because a
/// mouse that does not move sends nothing.  Without link, trial or position the force fades to zero
/// within 50 ticks.  The force is bounded and slew-limited.
/// Source: README Eq. HO-6; equilibrium-point control (Feldman 1986).
/// Pure; step() never allocates, locks or throws.
class PointerOperator {
 public:
  struct Config {
    double smoothing_rad_s = 25.0;
    std::int64_t stale_age_ticks = 500;
    ArmFeel arm;

    template <typename Visitor, typename Self>
    static void fields(Visitor&& visit, Self& self) {
      visit("smoothing_rad_s", self.smoothing_rad_s, Range{5.0, 200.0},
            "[rad/s] w_n of the second-order lag that smooths the 60 Hz pointer samples; the arm "
            "of a person has about 13");
      visit("stale_age_ticks", self.stale_age_ticks, Range{1.0, 60000.0},
            "[ticks] age from which a pointer is flagged as stale");
      visit.group("arm", self.arm);
    }
  };

  /// @throws stillhand::ConfigError naming the first field that is out of range.
  explicit PointerOperator(const Config& config);

  /// Begins a new trial: the arm starts at rest, upright.
  void arm(const Trial& trial) noexcept;

  OperatorOutput step(const PointerInput& input) noexcept;

 private:
  Config config_;
  signal::SecondOrderLag smoothing_;
  signal::ForceEnvelope envelope_;
  Tick last_tick_ = -1;
};

}  // namespace stillhand::human_operator

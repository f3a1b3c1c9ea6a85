// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "apps/libraries/session/core/trial_forces.hpp"
#include "apps/libraries/session/loop.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/core/cancellation/parts/command_filter.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/display/tracking_display.hpp"
#include "services/core/human_operator/crossover_operator.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/identification/tracking_metrics.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/recording/recording.hpp"

namespace stillhand::session {

/// Settings of every core of a session.
struct CoreConfigs {
  rig::RigConfig rig;
  sensing::Config sensing;
  motion::MotionGenerator::Config motion;
  cancellation::Config cancellation;
  cancellation::HandCompliance command_filter = cancellation::kAverageHand;
  display::TrackingDisplay::Config display;
  human_operator::CrossoverConfig human_operator;
  identification::Config identification;
};

/// A trial's signals over its measured ticks: the pegged record at 1 kHz, all others every
/// `keep_every` ticks.
struct TrialSignals : ForceSignals {
  identification::Record pegged;  ///< acceleration and force, 1 kHz, as sensed
  identification::TrackingRecord tracking;
  std::vector<cancellation::AdaptiveGain::Pair> weights;  ///< gain and phase over time
  recording::Recording measured;  ///< every channel that a session's recording has, 1 kHz
};

/// Share of the feedthrough force that the motor cancelled: 1 - RMS(f' + f_m) / RMS(f').
double cancelled_share(const std::vector<double>& feedthrough_n,
                       const std::vector<double>& motor_n);

/// [s] Delay of the motor's force after the feedthrough force that it opposes; negative: ahead. tau
/// in arg S_xy = -2 pi f tau, x = f', y = -f_m, least squares over the lines from 0.5 to 4 Hz
/// weighted by |S_xy|; NaN when the motor did nothing.
/// @param rate_hz  [Hz] of both
double counterforce_delay_s(const std::vector<double>& feedthrough_n, std::vector<double> motor_n,
                            double rate_hz);

/// The trials of a session in one process: the same cores in catalogue order around the Loop, as
/// fast as the machine goes.  The operator force reaches the rig one whole tick later.
/// Deterministic.  One thread.
class InProcessLoop {
 public:
  /// @param seed        session seed, used as the processes use theirs
  /// @param keep_every  ticks between two kept samples; 10 is the paper's recording rate
  /// @param effect      known to the rig alone; none by default
  /// @throws ConfigError as the cores do.
  InProcessLoop(const CoreConfigs& configs, std::uint64_t seed, Tick keep_every = 1,
                rig::SealedEffect effect = {});

  /// From now on run() keeps `measured` too.
  void keep_measured() noexcept { keeps_measured_ = true; }
  /// Runs one trial from its first ramp to its last; start_tick is set by the loop.
  TrialSignals run(PlannedTrial planned);
  /// The model the canceller uses from now on: at 1 kHz or, where its settings say so, at the rate
  /// of the fit.  @return why not, or kNone.
  cancellation::Refusal use_model(const identification::FeedthroughModel& model);
  cancellation::Refusal use_model(const cancellation::ControlModel& model);
  /// The effect of the rig, once the verdict on it is written: no trial runs after this call.
  [[nodiscard]] rig::OpenedEffect open_effect() { return loop_.open_effect(); }

 private:
  void arm(const PlannedTrial& planned);
  void tick_once(const PlannedTrial& planned, TrialSignals& signals);
  void keep(const PlannedTrial& planned, const sensing::Sensed& sensed, const rig::RigTruth& truth,
            const cancellation::CountermeasureOutput& cancelled,
            const display::TrackingSample& shown, TrialSignals& signals) const;
  void keep_row(const sensing::Sensed& sensed, const display::TrackingSample& shown,
                recording::Recording& rows) const;

  CoreConfigs configs_;
  Loop loop_;
  motion::MotionGenerator motion_;
  cancellation::Countermeasure countermeasure_;
  display::TrackingDisplay display_;
  human_operator::CrossoverOperator operator_;
  cancellation::CommandFilter command_filter_;
  Tick keep_every_;
  bool keeps_measured_ = false;
  Tick tick_ = 0;
  double operator_force_n_ = 0.0;
};

}  // namespace stillhand::session

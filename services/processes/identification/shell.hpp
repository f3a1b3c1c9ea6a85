// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "services/bus/service.hpp"
#include "services/core/cancellation/model_watch.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/identification/pegged_record.hpp"

namespace stillhand::identification {

/// The identification's process: a model from each pegged trial, and one of the feedthrough to
/// position from each trial with the stick free, fitted in a thread of its own.  While the motor
/// cancels it watches whether the model holds.
class Shell {
 public:
  explicit Shell(runtime::Service& service);
  void run();

 private:
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  void on_command(const stillhand_msgs::MotorCommand& command);
  void fit_trials(const std::stop_token& stop);
  stillhand_msgs::FeedthroughModel fit(const PeggedTrial& trial, TrialPhase phase);

  runtime::Service& service_;
  Config config_;
  PeggedRecord pegged_;                     ///< or that of a free stick
  TrialPhase phase_ = TrialPhase::kPegged;  ///< of the newest trial to be fitted
  std::int32_t models_ = 0;
  std::atomic<Tick> newest_tick_{0};
  /// Of the newest samples, at tick % size: a command answers one of them.
  struct Angle {
    Tick tick = -1;
    double theta_rad = 0.0;
  };
  std::array<Angle, 64> angles_{};
  std::optional<cancellation::ModelWatch> watch_;  ///< receiving thread only
  runtime::Publisher<stillhand_msgs::FeedthroughModel> model_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<PeggedTrial> finished_;  ///< waits for its fit
  TrialPhase finished_phase_ = TrialPhase::kPegged;
};

}  // namespace stillhand::identification

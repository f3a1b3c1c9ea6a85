// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <optional>
#include <thread>

#include "idl/control_loop.h"
#include "idl/model.h"
#include "services/bus/service.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/identification/pegged_record.hpp"

namespace stillhand::identification {

/// The identification's process: a model from each pegged trial, and one of the feedthrough to
/// position from each trial with the stick free, fitted in a thread of its own.
class Shell {
 public:
  explicit Shell(runtime::Service& service);
  void run();

 private:
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  void fit_trials(const std::stop_token& stop);
  stillhand_msgs::FeedthroughModel fit(const PeggedTrial& trial, TrialPhase phase);

  runtime::Service& service_;
  Config config_;
  PeggedRecord pegged_;                     ///< or that of a free stick
  TrialPhase phase_ = TrialPhase::kPegged;  ///< of the newest trial to be fitted
  std::int32_t models_ = 0;
  std::atomic<Tick> newest_tick_{0};
  runtime::Publisher<stillhand_msgs::FeedthroughModel> model_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  std::optional<PeggedTrial> finished_;  ///< waits for its fit
  TrialPhase finished_phase_ = TrialPhase::kPegged;
};

}  // namespace stillhand::identification

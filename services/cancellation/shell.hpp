// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "idl/model.h"
#include "idl/session.h"
#include "services/cancellation/codec.hpp"
#include "services/cancellation/core/canceller.hpp"
#include "services/cancellation/core/model_schedule.hpp"
#include "services/cancellation/core/perturbation.hpp"
#include "services/cancellation/core/trial_arming.hpp"
#include "services/runtime/process/handover.hpp"
#include "services/runtime/process/interlock.hpp"
#include "services/runtime/service.hpp"

namespace stillhand::cancellation {

/// The canceller's process: one motor command for each sensed sample, in the receiving thread.
/// Models are prepared in another thread and taken by the sample that ModelSchedule names.
class Shell {
 public:
  /// @param perturbation  force in place of cancelling; none: it cancels
  Shell(runtime::Service& service, const Config& config,
        std::optional<signal::Multisine> perturbation = {});
  void run() { service_.run(); }

 private:
  /// A model as it came.
  struct Received {
    ControlModel model;
    std::int32_t number;
    Tick from_tick;
  };
  /// A sound one, ready for the canceller.
  struct Ready {
    PreparedModel model;
    std::int32_t number;
    Tick from_tick;
  };

  void on_sensed(const stillhand_msgs::Sensed& sensed);
  void on_model(Received received);
  /// In the preparing thread: every model that has come since, in order.
  /// @return the newest sound one, or nullptr
  std::unique_ptr<Ready> prepare_received();
  /// Offers a model that has become ready, and hands the canceller the one that is due.
  void follow_models(Tick tick);
  void note_when_armed();
  void note_interlock(const Trial& trial);

  runtime::Service& service_;
  const Config config_;
  Canceller core_;
  std::optional<Perturbation> perturbation_;
  ModelSchedule schedule_;
  TrialArming arming_;
  runtime::Interlock interlock_;
  bool reported_latch_ = false;
  const Ready* ready_ = nullptr;  ///< the newest; the handover owns it
  std::atomic<const char*> why_no_model_{"no model has come"};  ///< a literal
  runtime::Publisher<stillhand_msgs::MotorCommand> command_;
  std::mutex mutex_;
  std::vector<Received> received_;     ///< not yet prepared
  runtime::Handover<Ready> handover_;  // last: its thread ends before the rest
};

}  // namespace stillhand::cancellation

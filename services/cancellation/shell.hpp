// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "idl/model.h"
#include "idl/session.h"
#include "services/cancellation/codec.hpp"
#include "services/cancellation/core/canceller.hpp"
#include "services/runtime/process/interlock.hpp"
#include "services/runtime/service.hpp"

namespace stillhand::cancellation {

/// The canceller's process: one motor command for each sensed sample, in the receiving thread.
class Shell {
 public:
  explicit Shell(runtime::Service& service);
  void run() { service_.run(); }

 private:
  void on_sensed(const stillhand_msgs::Sensed& sensed);
  /// @param number     of the model
  /// @param from_tick  first tick that it is used at
  void on_model(const ControlModel& model, std::int32_t number, Tick from_tick);
  void take_model_when_due(Tick tick);
  void note_when_armed();

  runtime::Service& service_;
  Canceller core_;
  runtime::Interlock interlock_;
  bool told_latch_ = false;
  struct ReadyModel {
    std::int32_t number;
    Tick from_tick;
  };
  std::optional<ReadyModel> ready_;
  std::int32_t model_ = -1;                         ///< in use
  const char* why_no_model_ = "no model has come";  ///< a literal
  std::optional<stillhand_msgs::TrialAssignment> assignment_;
  runtime::Publisher<stillhand_msgs::MotorCommand> command_;
};

}  // namespace stillhand::cancellation

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "idl/control_loop.h"
#include "idl/session.h"
#include "services/runtime/process/handover.hpp"
#include "services/runtime/service.hpp"
#include "services/vehicle/driven_motion.hpp"

namespace stillhand::vehicle {

/// The process in the place of the motion generator's: same topics, same lead.  A tracking trial
/// that moves is driven by the stick; any other trial has the motion of its assignment.
class Shell {
 public:
  Shell(runtime::Service& service, const DrivenConfig& config);
  void run() { service_.run(); }

 private:
  struct Prepared {
    motion::MotionTrajectory trajectory;
    Trial trial;
    bool driven = false;
  };

  void on_sensed(const stillhand_msgs::Sensed& sample);
  void prepare_when_complete();
  void report_end();

  runtime::Service& service_;
  DrivenConfig config_;
  DrivenMotion core_;
  runtime::Publisher<stillhand_msgs::PlatformCommand> command_;
  runtime::Handover<Prepared> handover_;
  std::int64_t armed_ = -1;  // number of a trial
  std::optional<stillhand_msgs::TrialAssignment> assignment_;
  std::int64_t prepared_trial_ = -1;
  std::int64_t ended_trial_ = -1;  // reported
  Tick last_ = -1;
};

}  // namespace stillhand::vehicle

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "services/bus/service.hpp"
#include "services/core/vehicle/driven_motion.hpp"
#include "services/processes/motion/assigned_trial.hpp"

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

  motion::AssignedTrial<Prepared>::Make plan(const stillhand_msgs::TrialAssignment& assignment,
                                             const Trial& trial) const;
  void on_sensed(const stillhand_msgs::Sensed& sample);
  void report_end();

  runtime::Service& service_;
  DrivenConfig config_;
  DrivenMotion core_;
  runtime::Publisher<stillhand_msgs::PlatformCommand> command_;
  motion::AssignedTrial<Prepared> trial_;
  std::int64_t ended_trial_ = -1;  // reported
  Tick last_ = -1;
};

}  // namespace stillhand::vehicle

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "idl/control_loop.h"
#include "services/bus/service.hpp"
#include "services/core/admittance/session_excitation.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/messages/motion/ride_file.hpp"
#include "services/processes/motion/assigned_trial.hpp"

namespace stillhand::motion {

/// What a trial's assignment on the bus leaves open.
struct RideAndRoad {
  std::filesystem::path ride;  ///< recorded ride for read_ride(), or empty
  std::string road_class = "B";
  double road_speed_m_s = 20.0;
  admittance::SessionPerturbation perturbation;  ///< its motion is that of a multisine's trial
};

/// The motion generator's process.  Sensed samples are its clock: each one brings the command for a
/// tick that lies `kLead` ahead, so that the rig always has it in time and two machines' clocks
/// cannot drift apart.
class Shell {
 public:
  /// Ticks between a command and the tick it is for: four times the DDS deadline.
  static constexpr Tick kLead = 20;

  /// @throws ConfigError when the ride cannot be read.
  Shell(runtime::Service& service, RideAndRoad way);
  void run() { service_.run(); }

 private:
  struct Prepared {
    MotionTrajectory trajectory;
    Trial trial;
  };

  AssignedTrial<Prepared>::Make plan(const stillhand_msgs::TrialAssignment& assignment,
                                     const Trial& trial);
  void on_sensed(Tick tick);
  void complete(MotionProfile& profile) const;
  void report_motion(const MotionProfile& profile, const MotionReport& report) const;

  runtime::Service& service_;
  MotionGenerator::Config config_;
  MotionGenerator core_;
  RideAndRoad way_;
  RideRecord ride_;
  runtime::Publisher<stillhand_msgs::PlatformCommand> command_;
  AssignedTrial<Prepared> trial_;
  Tick last_ = -1;
};

}  // namespace stillhand::motion

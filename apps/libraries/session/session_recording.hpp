// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "idl/clock.h"
#include "idl/control_loop.h"
#include "idl/model.h"
#include "idl/session.h"

namespace stillhand::session {

/// Everything of a recorded session, decoded, each topic in the order of arrival, without what
/// strangers wrote (services/messages/recording/named_writers.hpp).  Streams are in
/// tick order as long as nothing was lost or swapped; `lost_ticks` counts the gaps.
struct SessionRecording {
  std::vector<stillhand_msgs::PlatformCommand> platform_commands;
  std::vector<stillhand_msgs::RawSample> raw_samples;
  std::vector<stillhand_msgs::RigTruth> rig_truths;
  std::vector<stillhand_msgs::Sensed> sensed;
  std::vector<stillhand_msgs::MotorCommand> motor_commands;
  std::vector<stillhand_msgs::TrackingSample> tracking_samples;
  std::vector<stillhand_msgs::OperatorForce> operator_forces;
  std::vector<stillhand_msgs::Pointer> pointers;
  std::vector<stillhand_msgs::TrialControl> trial_controls;
  std::vector<stillhand_msgs::TrialAssignment> trial_assignments;
  std::vector<stillhand_msgs::FeedthroughModel> models;
  std::vector<stillhand_msgs::AugmentedModel> control_models;
  std::vector<stillhand_msgs::Event> events;
  std::vector<stillhand_msgs::ServiceStatus> statuses;
  std::vector<stillhand_msgs::ClockOffset> clock_offsets;

  std::int64_t first_log_ns = 0;  ///< [ns] log time of the first message, on the recorder's clock
  /// [ns] log time less the rig's stamp, the least of its samples: the same clock but for the way
  std::int64_t log_less_stamp_ns = 0;
  std::map<std::string, std::int64_t> messages;    ///< by topic
  std::map<std::string, std::int64_t> lost_ticks;  ///< by 1 kHz topic: gaps in its tick numbers
  std::vector<std::string> damage;                 ///< parts of the file that could not be read
};

/// Reads an MCAP file of a session.
/// @throws ConfigError when the file cannot be opened or is no recording of Stillhand.
SessionRecording read_session(const std::string& path);

/// Which parts of the rig were devices, in the rig's own words; empty: all were simulated.
std::string rig_parts_in(const SessionRecording& recording);

}  // namespace stillhand::session

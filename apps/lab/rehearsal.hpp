// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

#include "apps/libraries/session/protocol.hpp"
#include "services/core/motion/motion_trajectory.hpp"
#include "services/messages/motion/ride_file.hpp"

namespace stillhand::lab {

/// What each trial with motion asks of the platform, by the trial's number.
using AskedMotions = std::map<std::int64_t, motion::MotionReport>;

/// Makes the motion and the target of every trial once, before any process starts, as motion and
/// display will make them.  A motion that the platform cannot follow, or a target that the screen
/// cannot show, is refused before a subject sits there.
/// @param trials   that may run
/// @param options  road class and speed
/// @param ride    for MotionKind::kRide, otherwise empty
/// @param config  folder of motion.yaml and display.yaml
/// @throws ConfigError naming the option or setting, and what the platform would need
AskedMotions rehearse(const std::vector<session::PlannedTrial>& trials,
                      const session::ProtocolOptions& options, const motion::RideRecord& ride,
                      const std::filesystem::path& config);

}  // namespace stillhand::lab

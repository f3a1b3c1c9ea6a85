// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "idl/control_loop.h"
#include "services/display/core/tracking_display.hpp"

namespace stillhand::display {

TrackingInput from_idl(const stillhand_msgs::Sensed& sensed);
stillhand_msgs::TrackingSample to_idl(const TrackingSample& sample, Tick tick, std::int64_t trial);

}  // namespace stillhand::display

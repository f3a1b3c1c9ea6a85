// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "services/core/recording/messages/omgidl.hpp"

namespace stillhand::recording {

/// Types of a ROS 2 message definition, as MCAP files hold it (schema encoding "ros2msg"): the
/// message's own text, then for each type it needs a line of '=', a line "MSG: package/Type" and
/// that type's text.  Constants and defaults are left out; wide strings are kept as unsupported.  A
/// type without members has one octet, as on the bus.  Units come from "# [unit]" after a member.
/// Source: MCAP specification, "Well-known schema encodings"; ROS 2 design, "Interface definition".
/// @param name    type of the message: "sensor_msgs/msg/Imu"
/// @param source  name for messages, for example "F.mcap, schema 3"
/// @throws stillhand::ConfigError with the line.  Pure.
IdlSchema parse_ros2msg(std::string_view text, const std::string& name, const std::string& source);

}  // namespace stillhand::recording

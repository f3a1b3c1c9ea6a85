// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/core/recording/mcap/mcap_format.hpp"
#include "services/core/recording/messages/omgidl.hpp"

namespace stillhand::recording {

/// Schema encoding of ROS 2 recordings.
inline constexpr const char* kRos2SchemaEncoding = "ros2msg";

/// Types of a schema of a recording, in OMG IDL or ROS 2's own form.  `find(schema.name)` gives the
/// type of its messages.
/// @param source  name for messages
/// @throws stillhand::ConfigError for another encoding, a text that is wrong, or one that does not
///         define `schema.name`.  Pure.
IdlSchema parse_schema(const Schema& schema, const std::string& source);

}  // namespace stillhand::recording

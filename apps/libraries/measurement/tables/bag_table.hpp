// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "apps/libraries/measurement/tables/table_file.hpp"

namespace stillhand::measurement {

/// An MCAP file of any program whose messages are CDR with their definition in ROS 2's form or OMG
/// IDL: each number of a message is a column, "/imu.linear_acceleration.y".
/// RECORDINGS_OF_OTHER_PROGRAMS.md.
std::unique_ptr<TableFile> bag_table(const std::string& path, std::size_t most_values);

/// True if the recording holds samples of stillhand/sensed: a session's.
bool is_session(const std::string& path);

}  // namespace stillhand::measurement

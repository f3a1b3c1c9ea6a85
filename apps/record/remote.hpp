// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "apps/record/record.hpp"
#include "idl/recording.h"
#include "services/bus/recording/bus_recording.hpp"
#include "services/bus/remote_control.hpp"

namespace stillhand::record {

using Remote =
    runtime::RemoteControl<stillhand_msgs::RecorderCommand, stillhand_msgs::RecorderStatus>;

/// Options of a participant that is outside of every session.
runtime::Bus::Options outsider(const std::string& verb, const RecordOptions& options);

/// Carries out every command that has come.  @param windowed  an event window is kept
void execute(Remote& remote, recording::Tape& tape, bool windowed, runtime::Stop& stop);

/// @param missing  required topics that are silent
stillhand_msgs::RecorderStatus status_of(const Remote& remote, const recording::TapeStatus& tape,
                                         const std::map<std::string, recording::TopicTally>& topics,
                                         const std::string& missing);

}  // namespace stillhand::record

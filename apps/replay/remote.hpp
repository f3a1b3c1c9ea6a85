// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "apps/replay/player.hpp"
#include "idl/recording.h"
#include "services/bus/remote_control.hpp"

namespace stillhand::replay {

using Remote = runtime::RemoteControl<stillhand_msgs::ReplayCommand, stillhand_msgs::ReplayStatus>;

/// The recording that is played, for the status.
struct Played {
  std::string file;
  std::uint64_t start_ns;  ///< log time of the recording's first message
  std::uint64_t end_ns;    ///< and of its last
};

/// Carries out every command that has come; `quit` becomes true at a stop.
void execute(Remote& remote, Player& player, const Played& played, bool& quit);
void publish_status(Remote& remote, const Player& player, const Played& played);
/// The same, repeated for half a second at the end of the replay.
void publish_last_status(Remote& remote, const Player& player, const Played& played);

/// "seek 3.5" and the like as a command.  @throws ConfigError
stillhand_msgs::ReplayCommand parse_command(const std::string& text);

}  // namespace stillhand::replay

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "idl/session.h"
#include "services/bus/bus.hpp"

namespace stillhand::runtime {

/// Asks the rig for an emergency stop, as a dashboard does.  Its topic is made here, so before
/// Bus::start().  ask() from one thread.
class EmergencyStop {
 public:
  /// @param asker  what a person used, for the event; at most 64 characters
  EmergencyStop(Bus& bus, std::string asker)
      : commands_(bus.publisher<stillhand_msgs::SessionCommand>(topics::kSessionCommand)),
        asker_(std::move(asker)),
        request_(static_cast<std::uint64_t>(monotonic_ns())) {}

  /// Each call writes the same request: a reader that was not matched before gets it then.
  void ask() {
    stillhand_msgs::SessionCommand command;
    command.request(request_);
    command.action(stillhand_msgs::SESSION_EMERGENCY_STOP);
    command.asker(asker_);
    commands_.write(command);
  }

 private:
  Publisher<stillhand_msgs::SessionCommand> commands_;
  std::string asker_;
  std::uint64_t request_;
};

}  // namespace stillhand::runtime

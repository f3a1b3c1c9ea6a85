// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "apps/dashboard/core/request_rate.hpp"
#include "apps/dashboard/feed/live_bus.hpp"
#include "apps/dashboard/server/routes.hpp"
#include "idl/recording.h"
#include "idl/session.h"
#include "services/runtime/bus/bus.hpp"

namespace stillhand::dashboard {

/// What the page may ask of a session and of a recorder, on the bus.  The rig, the experiment and
/// the recorder decide what comes of it, and say so in events.  One thread.
class Remote {
 public:
  /// @throws as runtime::Bus does
  Remote(const LiveOptions& options, std::uint32_t rig);

  /// @param path  "/session/start", "/session/pause", "/session/stop", "/emergency-stop",
  ///              "/recorder/pause", "/recorder/resume", "/recorder/trigger", "/recorder/stop"
  /// Done is what somebody heard who does it: the rig an emergency stop, the experiment the others,
  /// a `stillhand record` its own.
  Outcome ask(std::string_view path);
  /// Into the session's events.
  Outcome note(const std::string& what);
  /// Ten times a second: an emergency stop is written again for some seconds, so that it reaches a
  /// rig that was out of reach when it was asked for.
  void step();

 private:
  Outcome stop_at_once();
  void send(stillhand_msgs::SessionAction action, const std::string& text);

  std::string nobody_;
  runtime::Bus bus_;
  runtime::Publisher<stillhand_msgs::SessionCommand> session_;
  runtime::Publisher<stillhand_msgs::RecorderCommand> recorder_;
  std::string asker_;
  std::uint64_t request_;
  RequestRate rate_;
  std::int64_t stop_until_ns_ = 0;  // monotonic clock
};

}  // namespace stillhand::dashboard

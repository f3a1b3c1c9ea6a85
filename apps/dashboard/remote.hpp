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
#include "services/bus/bus.hpp"

namespace stillhand::dashboard {

/// Sends the page's requests to sessions and recorders over the bus.  Rig, experiment and recorder
/// decide about them and report the outcome as events.  One thread.
class Remote {
 public:
  /// @throws as runtime::Bus does
  Remote(const LiveOptions& options, std::uint32_t rig);

  /// @param path  "/session/start", "/session/pause", "/session/stop", "/session/repeat",
  ///              "/session/abort", "/session/note", "/emergency-stop",
  ///              "/recorder/pause", "/recorder/resume", "/recorder/trigger", "/recorder/stop"
  /// Done means delivered: an emergency stop to a rig, other session requests to an experiment, a
  /// recorder request to a `stillhand record`.
  /// @param text  the reason of "/session/repeat" and "/session/abort", the words of
  ///              "/session/note"; these three are refused without it
  Outcome ask(std::string_view path, const std::string& text);
  /// Publishes a note among the session's events.
  Outcome note(const std::string& what);
  /// Ten times a second: an emergency stop is repeated for 5 s, so that it reaches a rig that
  /// was not connected at the first time.
  void step();

 private:
  Outcome stop_at_once();
  void send(stillhand_msgs::SessionAction action, const std::string& text);

  std::string domain_;  // begins a refusal
  runtime::Bus bus_;
  runtime::Publisher<stillhand_msgs::SessionCommand> session_;
  runtime::Publisher<stillhand_msgs::RecorderCommand> recorder_;
  std::string asker_;
  std::uint64_t request_;
  RequestRate rate_;
  std::int64_t stop_until_ns_ = 0;  // monotonic clock
};

}  // namespace stillhand::dashboard

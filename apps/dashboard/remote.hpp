// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "dashboard/live_bus.hpp"
#include "idl/recording.h"
#include "idl/session.h"
#include "runtime/bus.hpp"

namespace stillhand::dashboard {

/// What the page may ask of a session and of a recorder, on the bus.  The rig, the experiment and
/// the recorder decide what comes of it, and say so in events.  One thread.
class Remote {
 public:
  /// @throws as runtime::Bus does
  Remote(const LiveOptions& options, std::uint32_t rig);

  /// @param path  "/session/start", "/session/pause", "/session/stop", "/emergency-stop",
  ///              "/recorder/pause", "/recorder/resume", "/recorder/trigger", "/recorder/stop"
  /// @return why it could not be asked, "" when it was; nothing when there is no such action
  std::optional<std::string> ask(std::string_view path);
  /// Into the session's events.
  void note(const std::string& what);
  /// Ten times a second: an emergency stop is written again for some seconds, so that it reaches a
  /// rig that was out of reach when it was asked for.
  void step(std::int64_t now_ns);

 private:
  void send(stillhand_msgs::SessionAction action, const std::string& text);
  [[nodiscard]] bool heard(const topics::Topic& topic) const;

  std::uint32_t domain_;
  runtime::Bus bus_;
  runtime::Publisher<stillhand_msgs::SessionCommand> session_;
  runtime::Publisher<stillhand_msgs::RecorderCommand> recorder_;
  std::string asker_;
  std::int64_t stop_until_ns_ = 0;
};

}  // namespace stillhand::dashboard

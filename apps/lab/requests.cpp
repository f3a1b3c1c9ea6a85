// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/requests.hpp"

#include <algorithm>

namespace stillhand::lab {
namespace {

// It comes from the network and goes to terminals.
std::string printable(std::string text) {
  std::erase_if(text, [](char c) { return c < ' ' || c > '~'; });
  return text.empty() ? "?" : text;
}

}  // namespace

std::string Requests::take(const stillhand_msgs::SessionCommand& command, bool trial_runs) {
  constexpr std::size_t kMostAskers = 100;  // a stranger's names must not fill the memory
  const std::string asker = printable(command.asker().c_str());
  if (command.action() == stillhand_msgs::SESSION_EMERGENCY_STOP) {
    // Whatever was heard before.
    if (!emergency_.empty()) return "";
    emergency_ = "emergency stop, asked by " + asker;
    return emergency_;
  }
  if (newest_.size() >= kMostAskers) newest_.clear();
  std::uint64_t& newest = newest_[asker];
  if (command.request() <= newest) return "";
  newest = command.request();
  const std::string asked = ", asked by " + asker;
  switch (command.action()) {
    case stillhand_msgs::SESSION_START: {
      const bool was = paused_;
      paused_ = false;
      return "start" + asked + (was ? "" : ": nothing was paused");
    }
    case stillhand_msgs::SESSION_PAUSE:
      paused_ = true;
      return "pause" + asked +
             (trial_runs ? ": after this trial" : ": no trial begins before a start");
    case stillhand_msgs::SESSION_STOP:
      paused_ = true;
      if (!trial_runs) return "stop" + asked + ": no trial runs, none begins before a start";
      trial_stopped_ = "stopped" + asked;
      return "stop" + asked + ": the trial ends, a start runs it again";
    case stillhand_msgs::SESSION_NOTE:
      return asker + ": " + printable(command.text().c_str());
    case stillhand_msgs::SESSION_EMERGENCY_STOP:
      break;  // above
  }
  return "something unknown" + asked + ": not done";
}

}  // namespace stillhand::lab

// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/requests.hpp"

#include <algorithm>

namespace stillhand::lab {
namespace {

// The text comes from the network and goes to terminals.
std::string printable(std::string text) {
  std::erase_if(text, [](char c) { return c < ' ' || c > '~'; });
  return text.empty() ? "?" : text;
}

}  // namespace

std::string Requests::take(const Command& command, bool trial_runs) {
  constexpr std::size_t kMostNotes = 1000;  // between two looks of the script
  const std::string asker = printable(command.asker);
  if (command.action == Action::kEmergencyStop) {
    // It counts whatever its number is.
    if (!emergency_.empty()) return "";
    emergency_ = "emergency stop, asked by " + asker;
    return emergency_;
  }
  if (!newest_.take(command.sender, command.request)) return "";
  const std::string asked = ", asked by " + asker;
  const std::string reason = printable(command.text);
  switch (command.action) {
    case Action::kStart: {
      const bool was = paused_;
      paused_ = false;
      ++starts_;
      return "start" + asked + (was ? "" : ": nothing was paused");
    }
    case Action::kPause:
      paused_ = true;
      return "pause" + asked +
             (trial_runs ? ": after this trial" : ": no trial begins before a start");
    case Action::kStop:
      paused_ = true;
      if (!trial_runs) return "stop" + asked + ": no trial runs, none begins before a start";
      trial_stopped_ = "stopped" + asked;
      return "stop" + asked + ": the trial ends, a start runs it again";
    case Action::kRepeat:
      if (!trial_runs) {
        asked_.repeat = reason;
        return "repeat" + asked + ": the last trial runs again: " + reason;
      }
      paused_ = true;
      trial_stopped_ = "repeated" + asked + ": " + reason;
      return "repeat" + asked + ": the trial ends, a start runs it again: " + reason;
    case Action::kAbort:
      asked_.aborted = "aborted" + asked + ": " + reason;
      return "abort" + asked + ": the session ends: " + reason;
    case Action::kNote:
      if (asked_.notes.size() < kMostNotes) asked_.notes.push_back(asker + ": " + reason);
      return asker + ": " + reason;
    case Action::kEmergencyStop:
    case Action::kUnknown:
      break;
  }
  return "something unknown" + asked + ": not done";
}

}  // namespace stillhand::lab

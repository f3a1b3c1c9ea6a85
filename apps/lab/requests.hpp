// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "idl/session.h"

namespace stillhand::lab {

/// What somebody outside asked of the session, and what it comes to.  Pure; one thread at a time.
class Requests {
 public:
  /// @param trial_runs  a trial is under way
  /// @return one line for the event: who, what, and what becomes of it; empty: it was heard before
  std::string take(const stillhand_msgs::SessionCommand& command, bool trial_runs);

  /// No trial begins.
  [[nodiscard]] bool paused() const noexcept { return paused_; }
  /// As if somebody had asked.
  void pause() noexcept { paused_ = true; }
  /// Why the trial that runs is to end now; empty: it isn't.
  [[nodiscard]] const std::string& trial_stopped() const noexcept { return trial_stopped_; }
  /// A trial begins.
  void begin_trial() noexcept { trial_stopped_.clear(); }
  /// Why the session is to end; empty: it isn't.  For good.
  [[nodiscard]] const std::string& emergency() const noexcept { return emergency_; }

 private:
  bool paused_ = false;
  std::string trial_stopped_, emergency_;
  std::map<std::string, std::uint64_t> newest_;  // by asker; requests are written several times
};

}  // namespace stillhand::lab

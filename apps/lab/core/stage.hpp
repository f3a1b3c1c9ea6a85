// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "apps/lab/core/seen.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::lab {

enum class SessionState : std::uint8_t { kRunning, kPaused, kEnding };

/// What trial control says.
struct Announcement {
  SessionState session = SessionState::kRunning;
  std::optional<Trial> trial;  ///< nothing: no trial runs
};

/// A line for the person at the terminal.
struct Progress {
  std::string what;
  double done = 0.0;  ///< [-] 0 to 1
};

/// What a step asks its shell for, in the order in which the shell performs it.
struct Actions {
  std::optional<Trial> assign;  ///< publish the trial's assignment
  std::optional<Announcement> announce;
  std::optional<Tick> give_model_from;  ///< give the canceller the model, to be used from this tick
  std::optional<Progress> progress;
  std::optional<std::string> note = {};  ///< an event of the session
};

/// One stage of a session, from its first step until it is over.  Pure: no clock, bus or thread;
/// the shell steps it whenever something came, and every 50 ms.
class Stage {
 public:
  Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;
  virtual ~Stage() = default;

  /// @param seen    all that came; a stage may forget events and take up requests
  /// @param now_ns  monotonic clock [ns]
  virtual Actions step(Seen& seen, std::int64_t now_ns) = 0;
  [[nodiscard]] bool over() const noexcept { return over_; }

 protected:
  void finish() noexcept { over_ = true; }

 private:
  bool over_ = false;
};

}  // namespace stillhand::lab

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/core/signal/newest_of_each.hpp"

namespace stillhand::lab {

/// What a dashboard can ask of a session.
enum class Action : std::uint8_t {
  kStart,
  kPause,
  kStop,
  kEmergencyStop,
  kNote,
  kRepeat,
  kAbort,
  kUnknown
};

/// One request of a dashboard, as it came from the bus.
struct Command {
  Action action = Action::kUnknown;
  std::uint64_t request = 0;  ///< number of the request, larger than the sender's last
  std::string asker;          ///< a name for a person; any bytes
  std::string text;           ///< of a note, or a reason; any bytes
  std::string sender = {};    ///< whose numbers count: the participant, as anybody may use a name
};

/// Requests that concern the protocol of an experiment, for its script.
struct Asked {
  std::optional<std::string> repeat;  ///< the last trial shall run again; its reason
  std::vector<std::string> notes;     ///< of a person, with who wrote each
  std::string aborted;                ///< why the session has to end; empty: it goes on
};

/// The requests of dashboards and their effect on the session.  Pure; one thread at a time.
class Requests {
 public:
  /// @param trial_runs  a trial is under way
  /// @return one line for the event: who asked, for what, and the effect; empty: a repetition
  std::string take(const Command& command, bool trial_runs);

  /// No trial begins.
  [[nodiscard]] bool paused() const noexcept { return paused_; }
  /// The same as a request for a pause.
  void pause() noexcept { paused_ = true; }
  /// Why the trial that runs has to end now; empty: it goes on.
  [[nodiscard]] const std::string& trial_stopped() const noexcept { return trial_stopped_; }
  /// Requests for a start so far.
  [[nodiscard]] std::int64_t starts() const noexcept { return starts_; }
  /// What was asked of the protocol since the last call.
  Asked take_asked() { return std::exchange(asked_, Asked{{}, {}, asked_.aborted}); }
  /// Why the session has to end now, in good order; empty: it goes on.
  [[nodiscard]] const std::string& aborted() const noexcept { return asked_.aborted; }
  /// A trial begins.
  void begin_trial() noexcept { trial_stopped_.clear(); }
  /// Why the session has to end; empty: it goes on.  Never taken back.
  [[nodiscard]] const std::string& emergency() const noexcept { return emergency_; }

 private:
  bool paused_ = false;
  std::int64_t starts_ = 0;
  Asked asked_;
  std::string trial_stopped_, emergency_;
  signal::NewestOfEach<std::string> newest_;
};

}  // namespace stillhand::lab

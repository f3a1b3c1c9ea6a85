// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/lab/core/prompt.hpp"
#include "apps/lab/core/requests.hpp"
#include "services/core/contract/tick.hpp"

namespace stillhand::lab {

/// A process that the conductor waits for.
struct Member {
  std::string name;       ///< on the bus
  bool prepares = false;  ///< reports that it is prepared before a trial begins
  bool ticks = false;     ///< reports ticks from the session's begin
};
using Roster = std::vector<Member>;

/// The process whose ticks are the sample clock.
inline constexpr std::string_view kSampleClock = "rig";
/// The process whose ticks are recorded.
inline constexpr std::string_view kRecorder = "recorder";

/// Misses since the session began [-].
struct Misses {
  std::int64_t deadline = 0;  ///< DDS's count, and silence that a reader found
  std::int64_t cycle = 0;     ///< own microsecond supervision
  std::int64_t lost_ticks = 0;
};

/// The newest status of a process.
struct ProcessSeen {
  bool matched = false;           ///< all its endpoints have matched
  std::string missing;            ///< peers of its endpoints that have not matched
  Tick tick = -1;                 ///< newest tick it handled; -1: none
  std::int64_t armed_trial = -1;  ///< newest trial it is prepared for; -1: none
  Tick armed_tick = -1;           ///< `tick` when it said so first
  Misses misses;                  ///< of the topics that it reads
};

enum class EventKind : std::uint8_t {
  kInterlockOpened,
  kForceZero,
  kModelRefused,
  kModelLoaded,
  kNote,
  kOther
};

/// One event on the bus.
struct EventSeen {
  EventKind kind = EventKind::kOther;
  std::string what;                 ///< the kind in words
  std::string source, topic, peer;  ///< process that reports it; topic and process concerned
  std::string text;                 ///< one line for a person
  std::string line;                 ///< all of it as one line
  Tick tick = -1;
  double by_us = 0.0;
};

/// The newest feedthrough model.
struct ModelSeen {
  std::int64_t trial = -1;  ///< pegged trial that it comes from
  bool usable = false;
  std::string text;  ///< why it is not usable
};

/// A process that ended or fell silent.
struct Death {
  std::string line;
  bool refused = false;  ///< it refused what the user gave it; `line` is its own
  bool silent = false;   ///< its life sign is gone: the process may still be there
};

/// Everything that came from the bus, the processes and the user so far.
struct Seen {
  std::map<std::string, ProcessSeen, std::less<>> processes;
  std::vector<EventSeen> events;
  Tick recorded_tick = -1;  ///< the recorder's disk has what ended before; -1: nothing
  std::optional<ModelSeen> model;
  std::optional<Death> ended;                ///< until Trouble takes it
  std::vector<std::string> missing_peers;    ///< of the conductor's own endpoints
  std::vector<std::string> duplicate_peers;  ///< processes that are on the bus twice
  Requests requests;
  std::vector<AnswerSeen> answers;  ///< of the participant, until a prompt takes them
  bool trial_runs = false;          ///< a request for a stop stops the trial
  bool interrupted = false;         ///< the user asked for the end

  /// A process's newest status.
  void take(const std::string& name, ProcessSeen status);
  [[nodiscard]] const ProcessSeen& process(std::string_view name) const;
  /// Newest tick of the sample clock; -1: none yet.
  [[nodiscard]] Tick newest_tick() const { return process(kSampleClock).tick; }
  [[nodiscard]] bool has(EventKind kind) const;
  [[nodiscard]] Misses misses() const;
};

}  // namespace stillhand::lab

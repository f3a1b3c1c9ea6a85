// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "idl/session.h"
#include "services/core/contract/trial.hpp"

namespace stillhand::session {

/// Events during a trial: those of one kind, topic, process and peer are one mark.
struct Mark {
  std::string what;         ///< "deadline missed", ...
  std::string source;       ///< process that reported it
  std::string topic;        ///< or empty
  std::string peer;         ///< or empty
  std::string text;         ///< of the first event
  std::int64_t first_tick;  ///< -1: not known
  std::int64_t count;       ///< events; each may stand for several within a tenth of a second
  double worst_us;          ///< [us], or [ticks] of "ticks lost"
};

Mark mark_of(const stillhand_msgs::Event& event);
/// One line for a person.
std::string line_of(const Mark& mark);
/// [s] of the trial since when the canceller's model no longer holds, below 0 before the trial;
/// none: the mark says nothing of it.
std::optional<double> model_lost_s(const Mark& mark, const Trial& trial);
/// The same as one clause; empty of every other mark.
std::string model_change(const Mark& mark, const Trial& trial);
/// Adds a mark, or counts it with the one that is the same.
void add_mark(std::vector<Mark>& marks, const Mark& mark);

}  // namespace stillhand::session

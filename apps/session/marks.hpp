// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "idl/session.h"

namespace stillhand::session {

/// What happened during a trial, events of one kind, topic, process and peer as one.
struct Mark {
  std::string what;         ///< "deadline missed", ...
  std::string source;       ///< process that said so
  std::string topic;        ///< or empty
  std::string peer;         ///< or empty
  std::string text;         ///< of the first
  std::int64_t first_tick;  ///< -1: not known
  std::int64_t count;       ///< events; each may stand for several within a tenth of a second
  double worst_us;          ///< [us], or [ticks] of "ticks lost"
};

Mark mark_of(const stillhand_msgs::Event& event);
/// As a line for a person.
std::string line_of(const Mark& mark);
/// One that is there already counts once more.
void add_mark(std::vector<Mark>& marks, const Mark& mark);

}  // namespace stillhand::session

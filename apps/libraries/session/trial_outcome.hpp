// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/marks.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/core/motion/motion_trajectory.hpp"

namespace stillhand::session {

/// Misses that every reader counted since the session began.
struct MissCounts {
  std::int64_t deadline = 0;  ///< DDS's count, and silence that a reader found
  std::int64_t cycle = 0;     ///< own microsecond supervision
  std::int64_t lost_ticks = 0;
};

/// How a trial ended.
struct TrialOutcome {
  PlannedTrial planned;
  bool completed = false;
  bool stopped = false;     ///< a request ended it: it is run again
  std::string aborted;      ///< why it was not completed, or empty
  std::string no_model;     ///< why an identification that counts gave none, or empty
  std::vector<Mark> marks;  ///< events during the trial, in order of their first
  MissCounts misses;        ///< during the trial, all readers together
  std::optional<motion::MotionReport> asked;  ///< of the platform, when it moves
};

}  // namespace stillhand::session

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "apps/lab/core/seen.hpp"

namespace stillhand::lab {

/// Finds the process that does its work no more although its life sign goes on: a thread of its own
/// writes the life sign.  During a trial every process answers the samples of the rig, so its
/// newest tick follows the sample clock.  Pure: times in nanoseconds come in.
class Standstill {
 public:
  /// @param roster  in the order of the data flow: a process without input stands still too, so the
  ///                first of those that stand is the cause
  /// @return one line, or nothing
  std::string look(const Seen& seen, const Roster& roster, std::int64_t now_ns);

 private:
  Tick clock_ = -1;                  ///< newest tick of the sample clock
  std::int64_t clock_since_ns_ = 0;  ///< when it came
};

}  // namespace stillhand::lab

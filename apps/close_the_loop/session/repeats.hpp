// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>

#include "apps/close_the_loop/session/conditions.hpp"
#include "apps/close_the_loop/session/session.hpp"

namespace stillhand::close_the_loop {

struct RepeatOptions {
  std::int64_t repeats = 10;
  unsigned threads = 1;
  /// Is given the share of the trials that have run; false ends the repeats.
  std::function<bool(double share)> progress = [](double) { return true; };
};

/// Runs every condition again with the models of a closed loop, README "Repeats": each trial on a
/// rig of its own, so that the trials of a repeat share motion, target, remnant and noise.  The
/// numbers do not depend on `threads`.
/// @param protocol  of the loop; the seeds of the repeats follow from its seed
/// @throws ConfigError as the cores do, diagnosis::Interrupted
Conditions run_repeats(const LoopResult& result, const session::ProtocolOptions& protocol,
                       const SimulatedRig& rig, const RepeatOptions& options);

}  // namespace stillhand::close_the_loop

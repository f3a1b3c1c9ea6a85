// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "apps/libraries/session/session_recording.hpp"

/// Who was late in a recorded session, when, and what the motor force did.  Pure.
///
/// A process of the loop writes one sample each tick, with the stamp of its own clock.  It is
/// silent from one stamp to the next; the part of this that is longer than the tick is the gap:
///
///   gap = (t[n] - t[n-1]) - T/2                                                          (MI-1)
///
/// T [s] the tick.  The process stopped at a moment of the tick that nobody recorded, so half of it
/// is taken off and the gap is right to T/2.  A process that waits for another one's samples is
/// silent as long as that one is; it is late by itself if its source was not silent for half of its
/// gap.  A gap is none of the process, and is left out, if somebody answered a sample inside it
/// that the recording lacks, or if ticks of the rig, which counts without a jump, are missing.
namespace stillhand::session {

/// One process that was late by itself.
struct Miss {
  std::string process;
  std::string topic;
  std::int64_t from_ns = 0;         ///< [ns] when its silence began, on the experiment's clock
  double late_s = 0.0;              ///< [s] Eq. MI-1
  double from_s = 0.0;              ///< [s] the same from the start of the recording
  std::int64_t trial = -1;          ///< in whose measured part or ramps it was; -1: in none
  double trial_s = 0.0;             ///< [s] from the first measured tick of the trial
  bool pegged = false;              ///< the trial is the identification
  std::vector<std::string> waited;  ///< processes behind it that were silent with it
  std::string why;                  ///< what its kernel said of it; empty: nothing
  double force_before_n = 0.0;      ///< [N] RMS of the motor force in the second before
  double zero_s = 0.0;              ///< [s] for how long the motor force was zero then
  double back_s = 0.0;  ///< [s] from then until the force is again what the prediction asks for;
                        ///< NaN: not before the trial's end.  0: the force was none, or not the
                        ///< prediction's, as that of a mitigation
};

/// In the order of time.
/// @param least_s  [s] a shorter gap is no miss; at least a tick
std::vector<Miss> misses_in(const SessionRecording& session, double least_s = 0.005);

/// "sensing was late by 77 ms, force 0 for 0.03 s, whole again after 0.1 s"
std::string what_happened(const Miss& miss);

}  // namespace stillhand::session

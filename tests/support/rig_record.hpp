// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "services/core/admittance/arm_model.hpp"
#include "services/core/admittance/line_responses.hpp"
#include "services/core/rig/rig.hpp"

/// Records of the simulated rig with the sensors and filters of a session, in one process.
namespace stillhand::simulated {

struct RigRun {
  rig::RigConfig rig;
  const signal::Multisine* motion = nullptr;  ///< of the platform, 1 kHz
  const signal::Multisine* force = nullptr;   ///< of the motor, 1 kHz; null: off
  bool pegged = false;
  std::int64_t periods = 8;  ///< after one that is left out
  /// The rig's load cell is read before the motor's force of its tick steps in, so that step shows
  /// half a tick late; true: the mean of before and after, as a cell with an analogue filter shows.
  bool mean_of_tick = true;
};
struct RigRecord {
  admittance::FreeStickRecord record;  ///< every fourth sample, 250 Hz
  /// What the body would exert on a held stick; truth, unfiltered, at the record's samples.
  std::vector<double> held_force_n;
};

/// Displacement and motor force pass the low-pass of sensing, as acceleration and force do; the
/// motor's is the mean over the tick of what acted, so a ratio has neither a filter nor a hold.
RigRecord record(const RigRun& run);

/// The arm that the rig's body has while it holds the free stick, or the idle one on the peg.
admittance::ArmValues arm_of(const rig::RigConfig& config, bool pegged);
admittance::StickValues stick_of(const rig::StickConfig& stick);

}  // namespace stillhand::simulated

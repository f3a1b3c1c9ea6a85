// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>

#include "apps/libraries/session/session_recording.hpp"
#include "services/files/settings/load.hpp"
#include "tests/equivalence/replay.hpp"

namespace stillhand::equivalence {

/// What the processes of a session were started with.
struct SessionSettings {
  std::filesystem::path config;  ///< folder of <service>.yaml
  std::uint64_t seed = 0;

  template <typename Config>
  [[nodiscard]] Config of(const std::string& service) const {
    return settings::load<Config>(config / (service + ".yaml"), service);
  }
};

using session::SessionRecording;

// Each replays one core in this process: inputs, order of calls and settings as in the service's
// shell, outputs compared with the recorded ones.
Replay replay_sensing(const SessionRecording& session, const SessionSettings& settings);
/// @param vehicle  of the process in the place of the motion process, as its --vehicle
Replay replay_vehicle(const SessionRecording& session, const SessionSettings& settings,
                      const std::string& vehicle);
Replay replay_motion(const SessionRecording& session, const SessionSettings& settings);
Replay replay_cancellation(const SessionRecording& session, const SessionSettings& settings);
Replay replay_display(const SessionRecording& session, const SessionSettings& settings);
/// The simulated subject.
Replay replay_human_operator(const SessionRecording& session, const SessionSettings& settings);
/// RigTruth and RawSample, each counted.
Replay replay_rig(const SessionRecording& session, const SessionSettings& settings);
/// Each pegged trial's model, one comparison a model; `first_tick` is that of the first trial.
Replay replay_identification(const SessionRecording& session, const SessionSettings& settings);

}  // namespace stillhand::equivalence

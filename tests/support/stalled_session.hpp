// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "apps/libraries/session/on_time.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "services/core/contract/trial.hpp"

/// A session whose stalls, limits and noise are known: the same session without them shows what
/// they did.
namespace stillhand::tests {

inline constexpr Tick kStalledStart = 6000, kStalledLength = 30000;

struct Faults {
  Tick stall_ticks = 0;          ///< in each second a process stands still so long
  bool of_sensing = true;        ///< the process; else the canceller
  double max_force_n = 25.0;     ///< limit of the canceller
  double involuntary_n = 0.0;    ///< of the body
  double accel_noise = 0.00108;  ///< [(m/s^2)/sqrt(Hz)]
  std::uint64_t seed = 1;        ///< of noise and stalls
};

struct StalledSession {
  session::SessionRecording recording;
  Trial trial;
  std::vector<double> feedthrough_n, motor_n;  ///< over the measured ticks
};

session::AnswerConfigs configs_of(const Faults& faults);

/// Rig, conditioner and canceller with a static model, and what the processes write; the same f'
/// for the same seed, whatever else is wrong.
StalledSession stalled_session(const Faults& faults);

/// Mean of the product of what is left with a part of it, over the RMS of what is left: Eq. SN-8.
double share_n(const StalledSession& session, const std::vector<double>& part_n);
std::vector<double> difference(const std::vector<double>& a, const std::vector<double>& b);

}  // namespace stillhand::tests

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/libraries/session/on_time.hpp"
#include "apps/libraries/session/protocol.hpp"
#include "services/bus/recording/keep_options.hpp"
#include "services/bus/recording/of_experiment.hpp"
#include "services/core/cancellation/config.hpp"

namespace stillhand::lab {

/// Who tracks the target.
enum class Operator : std::uint8_t { kSimulated, kMouse };

/// The command line of `stillhand lab`.
struct LabOptions {
  session::ProtocolOptions protocol;
  /// Trials that may run, for the rehearsal; empty: those of session::plan(protocol).
  std::vector<session::PlannedTrial> trials;
  std::filesystem::path out;       ///< folder of the results
  std::filesystem::path ride;      ///< recorded ride, for MotionKind::kRide or a plan
  std::filesystem::path programs;  ///< folder of the stillhand-* executables
  std::filesystem::path profiles;  ///< qos/profiles.xml
  std::filesystem::path config;    ///< folder of the services' settings
  std::uint32_t domain = 0;
  std::uint32_t rig = 1;
  std::string vehicle;            ///< that the stick drives in B and C; empty: none
  std::filesystem::path devices;  ///< which device serves which signal; empty: the simulated rig
  bool headless = false;
  bool video = false;            ///< headless display writes DIR/screen.avi
  bool real_time = true;         ///< ask for a real-time scheduling policy
  bool traces_switches = false;  ///< of the kernel, for `stillhand misses --why`
  Operator who = Operator::kSimulated;
  std::filesystem::path gamepad;  ///< input device in place of the mouse; empty: the mouse
  std::int64_t subject = 0;  ///< of the population, under the session's seed; 0: that of `config`
  std::optional<std::uint64_t> subject_seed;  ///< of that draw; none: the session's
  std::filesystem::path security;             ///< folder of keys; empty: none, or the inventory's
  std::filesystem::path inventory;            ///< the lab's machines; empty: this one
  std::filesystem::path model;                ///< control model for C; empty: the session's own
  std::string canceller = "now";              ///< cancellation::sampling_named()
  std::string task = "hold";                  ///< of the simulated person in a perturbed trial
  std::uint64_t undeclared_effect = 0;  ///< seed of the effect that only the rig knows; 0: none
  double match_s = 20.0;                ///< [s] patience until every endpoint has matched
  bool attach = false;                  ///< use services that run already
  bool wait_for_start = false;          ///< each trial waits for a start from the dashboard
  bool close_live = false;              ///< LiveClosing
  std::filesystem::path stop_key;       ///< evdev device for the emergency stop; empty: none
  recording::KeepOptions keep;          ///< of the session's recording
  recording::OfExperiment experiment;   ///< whose participant is recorded; empty: none
};

/// Sets programs, profiles and config: those of the build tree or of an installed prefix.
void set_places(LabOptions& options);

/// The pegged trial alone, in the motion of a plan of `stillhand plan-run`.
/// @throws ConfigError for a file that is none
void take_plan(const std::filesystem::path& plan, LabOptions& options);

/// Settings of the process of cancellation in this session.
/// @throws ConfigError when their file is wrong.
cancellation::Config canceller_config(const LabOptions& options);

/// Settings of what lies between a raw sample and the motor's force.  None with a rig of devices,
/// of which nobody knows the feedthrough; nor where a file is wrong by now, which a line says: it
/// must not cost a session its results.
std::optional<session::AnswerConfigs> answers_of(const LabOptions& options);

}  // namespace stillhand::lab

// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/check_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "apps/lab/control_model.hpp"
#include "apps/lab/core/prompt.hpp"
#include "apps/lab/live_closing.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "services/core/cancellation/config.hpp"
#include "services/core/cancellation/parts/countermeasure.hpp"
#include "services/core/cancellation/parts/recipe.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/identification/identifier.hpp"
#include "services/core/motion/motion_generator.hpp"
#include "services/core/vehicle/vehicle_settings.hpp"
#include "services/devices/device_rig/load_devices.hpp"
#include "services/files/settings/load.hpp"
#include "services/messages/motion/ride_file.hpp"
#include "services/system/process/domain.hpp"

namespace stillhand::lab {
namespace {

// Before anything starts: the words of the file.  The devices themselves are the rig's business.
void check_devices(const LabOptions& options) {
  if (options.undeclared_effect != 0) {
    throw ConfigError("--undeclared-effect", "it with --rig devices",
                      "it with the simulated rig alone: a real arm takes no planted effect");
  }
  if (options.attach) {
    throw ConfigError("--attach", "--rig devices with it",
                      "the rig of devices as a service that runs already");
  }
  if (!options.inventory.empty() && options.devices.parent_path() != options.config) {
    throw ConfigError("--rig", options.devices.string() + " with --inventory",
                      "devices: the devices.yaml of --config, which goes to the rig's host");
  }
  device_rig::load_devices(options.devices);
}

// Refuses an option with those of the others that are given.
void refuse_with(const char* option, const std::vector<std::pair<const char*, bool>>& others,
                 const char* want) {
  std::vector<const char*> given;
  for (const auto& [name, is_given] : others) {
    if (is_given) given.push_back(name);
  }
  if (given.empty()) return;
  throw ConfigError(option, fmt::format("{} with it", fmt::join(given, ", ")), want);
}

void check_combinations(const LabOptions& options) {
  if (!options.protocol.planned &&
      (options.protocol.motion == motion::MotionKind::kRide) == options.ride.empty()) {
    throw ConfigError("--ride", options.ride.empty() ? "nothing" : options.ride.string(),
                      "a file with --motion ride, and no file without it");
  }
  if (options.who == Operator::kMouse && options.headless) {
    throw ConfigError("--operator", "mouse together with --headless", "a window for the mouse");
  }
  if (!options.devices.empty()) check_devices(options);
  const bool other_motion = options.protocol.motion != motion::MotionKind::kBandNoise;
  if (options.protocol.perturb_period_s != 0.0) {
    refuse_with("--identify",
                {{"--attach", options.attach},
                 {"--inventory", !options.inventory.empty()},
                 {"--model", !options.model.empty()},
                 {"--vehicle", !options.vehicle.empty()},
                 {"--canceller", options.canceller != "now"},
                 {"--motion", other_motion}},
                "it alone: the motor perturbs in place of cancelling");
  }
  if (options.attach) {
    refuse_with("--attach",
                {{"--undeclared-effect", options.undeclared_effect != 0},
                 {"--subject", options.subject != 0},
                 {"--video", options.video},
                 {"--operator mouse", options.who == Operator::kMouse},
                 {"--motion", other_motion}},
                "these as arguments of the services, which run already");
  }
}

// What the watch watches, where the recording is read while it is written.
void check_closing(const LabOptions& options) {
  if (!options.close_live) return;
  if (std::ranges::find(options.protocol.conditions, session::Condition::kC) ==
      options.protocol.conditions.end()) {
    throw ConfigError("--close", "live without the condition C", "it with C");
  }
  refuse_with("--close live",
              {{"--model", !options.model.empty()},
               {"--canceller", options.canceller != "now"},
               {"--attach", options.attach},
               {"--inventory", !options.inventory.empty()}},
              "it with the session's own model, on one machine");
  if (settings::load<identification::Config>(options.config / "identification.yaml",
                                             "identification")
          .false_alarms_h == 0.0) {
    throw ConfigError("--close", "live with identification.false_alarms_h 0",
                      "it with a watch on the model");
  }
  // Cancellation's CC-20 and statistics' ST-22: twelve blocks of 4 s behind 3 s of settling.
  constexpr double kLeast_s = 55.0;
  if (options.protocol.trial_s < kLeast_s) {
    throw ConfigError("--trial-seconds",
                      fmt::format("{:g} with --close live", options.protocol.trial_s),
                      "55 or more: the watch judges from 51 s of a trial on");
  }
  report::require_gnuplot();  // the diagnosis draws
}

// As the process of cancellation will make it, with models in place of those that the session
// identifies: of the rate that it takes, and of a gain below every bound of its settings.
cancellation::Countermeasure made(const LabOptions& options, const cancellation::Config& config,
                                  const session::PlannedTrial& planned) {
  auto recipe =
      recipe_of(planned.parts, signal::DifferenceModel{kControlRateHz, {-0.001}, {1.0}}, config);
  if (needs_force(planned.parts)) {
    recipe.model =
        options.model.empty()
            ? cancellation::control_model({config.sampling.model_rate_hz(), {-0.5}, {1.0}})
            : control_model(options.model, options.rig, options.config);
  }
  return cancellation::Countermeasure(config, recipe);
}

// From its assignment to the first measured tick it settles and fades in (CC-18).  A model that the
// session identifies is judged when it is there.
void check_settling(const cancellation::Countermeasure& mitigation,
                    const cancellation::Config& config, const session::PlannedTrial& planned) {
  const auto lead_ticks =
      static_cast<std::int64_t>(kTrialLead_s * kControlRateHz) + planned.trial.ramp_ticks;
  const std::int64_t needs_ticks = mitigation.settle_ticks() + config.fade_ticks;
  if (needs_ticks <= lead_ticks) return;
  throw ConfigError("cancellation.fade_ticks and --model",
                    fmt::format("{} ms to settle and fade in", needs_ticks),
                    fmt::format("at most the {} ms before a trial", lead_ticks));
}

// Builds each mitigation as the process of cancellation will: what it refuses at the trial is
// refused before the first one.
void check_mitigations(const LabOptions& options,
                       const std::vector<session::PlannedTrial>& trials) {
  if (std::ranges::all_of(trials, [](const auto& each) { return each.parts.empty(); })) return;
  const cancellation::Config config = canceller_config(options);
  for (const session::PlannedTrial& planned : trials) {
    if (planned.parts.empty()) continue;
    try {
      check_settling(made(options, config, planned), config, planned);
    } catch (const ConfigError& error) {
      const std::string name = session::name_of(planned.label);
      throw ConfigError(
          "--conditions",
          options.canceller == "now" ? name : name + " with --canceller " + options.canceller,
          fmt::format("a mitigation that the canceller of this session runs ({})", error.what()));
    }
  }
}

void check_driven(const LabOptions& options, const std::vector<session::PlannedTrial>& trials) {
  if (options.vehicle.empty()) return;
  for (const session::PlannedTrial& planned : trials) {
    if (planned.parts.empty()) continue;
    throw ConfigError("--vehicle",
                      fmt::format("{} with {}", options.vehicle, session::name_of(planned.label)),
                      "it with A, B and C alone: the vehicle follows the raw stick, not the "
                      "command that a mitigation gives");
  }
}

// The name, the settings, and their bounds, before anything starts.
void check_vehicle(const LabOptions& options) {
  if (options.vehicle.empty()) return;
  if (options.attach) {
    throw ConfigError("--attach", "--vehicle with it", "stillhand-vehicle_motion as a service");
  }
  const auto limits =
      settings::load<motion::MotionGenerator::Config>(options.config / "motion.yaml", "motion")
          .limits;
  const auto settings =
      settings::load<vehicle::VehicleSettings>(options.config / "vehicle.yaml", "vehicle");
  const vehicle::DrivenMotion checked(vehicle::driven_config(limits, settings, options.vehicle));
}

void check_values(const LabOptions& options) {
  if (options.domain > runtime::kMaxDomain) {
    throw ConfigError("--domain", fmt::to_string(options.domain),
                      fmt::format("0 to {}", runtime::kMaxDomain));
  }
  if (!(options.match_s > 0.0 && options.match_s <= 3600.0)) {
    throw ConfigError("--match-seconds", fmt::format("{:f}", options.match_s),
                      "more than 0 and at most 3600 seconds");
  }
  if (!std::filesystem::is_regular_file(options.profiles)) {
    throw ConfigError("--profiles", "no file " + options.profiles.string(), "qos/profiles.xml");
  }
}

motion::RideRecord ride_of(const LabOptions& options) {
  if (options.ride.empty()) return {};
  motion::RideRecord ride = motion::read_ride(options.ride.string());
  const session::ProtocolOptions& protocol = options.protocol;
  const double wanted_s = protocol.planned ? protocol.identify_s : protocol.trial_s;
  if (ride.length_s() < wanted_s) {
    throw ConfigError(
        options.ride.string(), fmt::format("{:f} s of ride", ride.length_s()),
        fmt::format("at least the {} {:f}",
                    protocol.planned ? "plan's seconds," : "--trial-seconds", wanted_s));
  }
  return ride;
}

}  // namespace

AskedMotions check_options(const LabOptions& options) {
  const auto planned = session::plan(options.protocol);  // checks durations and road
  auto trials = options.trials.empty() ? planned : options.trials;
  check_combinations(options);
  check_closing(options);
  if (options.close_live) {
    for (const auto& each : closing_trials(options.protocol)) trials.push_back(each);
  }
  check_driven(options, trials);
  check_mitigations(options, trials);
  check_values(options);
  check_vehicle(options);
  return rehearse(trials, options.protocol, ride_of(options), options.config);
}

}  // namespace stillhand::lab

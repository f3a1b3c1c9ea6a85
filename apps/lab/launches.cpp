// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/launches.hpp"

#include <fmt/format.h>

#include <string_view>

#include "idl/processes.hpp"
#include "services/bus/recording/keep_options.hpp"
#include "services/bus/recording/of_experiment.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/core/device_rig/parts_note.hpp"
#include "services/files/settings/load.hpp"

namespace stillhand::lab {
namespace {

using Arguments = std::vector<std::string>;

Arguments shared_words(const LabOptions& options, const Hosts& hosts, const Place& place) {
  Arguments words{"--domain",   fmt::to_string(hosts.domain()),
                  "--rig",      fmt::to_string(options.rig),
                  "--seed",     fmt::to_string(options.protocol.seed),
                  "--profiles", place.profiles.string(),
                  "--config",   place.config.string()};
  if (options.real_time) words.push_back("--real-time");
  if (options.traces_switches) words.push_back("--trace-switches");
  if (!place.security.empty()) words.insert(words.end(), {"--security", place.security.string()});
  return words;
}

Arguments recorder_words(const LabOptions& options, const Place& place) {
  Arguments words{"--out", (place.out / "session.mcap").string()};
  const Arguments keep = recording::keep_words(options.keep);
  words.insert(words.end(), keep.begin(), keep.end());
  const Arguments experiment = recording::experiment_words(options.experiment);
  words.insert(words.end(), experiment.begin(), experiment.end());
  return words;
}

// What the assignment on the bus does not say.
Arguments perturb_words(const session::ProtocolOptions& protocol) {
  Arguments words{"--perturb-period-s", fmt::format("{:.17g}", protocol.perturb_period_s),
                  "--perturb-seed", fmt::to_string(protocol.seed)};
  if (protocol.perturb_swapped) words.push_back("--perturb-swapped");
  return words;
}

Arguments motion_words(const LabOptions& options) {
  if (!options.vehicle.empty()) return {"--vehicle", options.vehicle};
  const session::ProtocolOptions& protocol = options.protocol;
  if (protocol.perturb_period_s != 0.0) return perturb_words(protocol);
  if (protocol.planned) return {"--ride", options.ride.string()};
  switch (protocol.motion) {
    case motion::MotionKind::kRide:
      return {"--ride", options.ride.string()};
    case motion::MotionKind::kRoad:
      // Every bit of the double.
      return {"--road-class", protocol.road_class, "--speed-m-s",
              fmt::format("{:.17g}", protocol.road_speed_m_s)};
    case motion::MotionKind::kStill:
    case motion::MotionKind::kBandNoise:
    case motion::MotionKind::kMultisine:
      break;
  }
  return {};
}

Arguments display_words(const LabOptions& options, const Place& place) {
  Arguments words;
  if (options.headless) words.push_back("--headless");
  if (options.video) words.insert(words.end(), {"--video", (place.out / "screen.avi").string()});
  if (options.who == Operator::kMouse) words.push_back("--pointer");
  if (!options.gamepad.empty()) {
    words.insert(words.end(), {"--gamepad", options.gamepad.string()});
  }
  if (!options.devices.empty()) {
    const auto devices = settings::load<device_rig::DevicesConfig>(options.devices, "devices");
    words.insert(words.end(), {"--rig-parts", std::string(device_rig::kPartsNote) +
                                                  device_rig::in_words(devices.signals)});
  }
  return words;
}

// Most services need none.
Arguments own_words(std::string_view service, const LabOptions& options, const Place& place) {
  if (service == "recorder") return recorder_words(options, place);
  if (service == "motion") return motion_words(options);
  if (service == "display") return display_words(options, place);
  if (service == "cancellation" && options.protocol.perturb_period_s != 0.0) {
    return perturb_words(options.protocol);
  }
  if (service == "cancellation" && options.canceller != "now") {
    return {"--canceller", options.canceller};
  }
  if (service == "human_operator" && options.who == Operator::kMouse) return {"--pointer"};
  return {};
}

}  // namespace

std::vector<Launch> launches(const LabOptions& options, const Hosts& hosts,
                             const std::string& experiment, const std::string& sealed) {
  std::vector<Launch> list;
  for (const std::string_view service : topics::kLaunchOrder) {
    const Place place = hosts.of(service);
    Launch launch;
    launch.name = service;
    const bool devices = service == "rig" && !options.devices.empty();
    const bool driven = service == "motion" && !options.vehicle.empty();
    launch.executable = options.programs / (devices  ? "stillhand-device_rig"
                                            : driven ? "stillhand-vehicle_motion"
                                                     : "stillhand-" + launch.name);
    launch.log = options.out / "logs" / (launch.name + ".log");
    launch.arguments = shared_words(options, hosts, place);
    launch.arguments.insert(launch.arguments.end(), {"--experiment", experiment});
    const Arguments own = own_words(service, options, place);
    launch.arguments.insert(launch.arguments.end(), own.begin(), own.end());
    // On another host it reads the copy among its settings.
    if (devices && options.inventory.empty()) {
      launch.arguments.insert(launch.arguments.end(), {"--devices", options.devices.string()});
    }
    if (service == "rig" && !sealed.empty()) {
      launch.arguments.insert(launch.arguments.end(),
                              {"--undeclared-effect", "--out", options.out.string()});
      launch.standard_input = sealed;
    }
    list.push_back(hosts.placed(launch));
  }
  return list;
}

}  // namespace stillhand::lab

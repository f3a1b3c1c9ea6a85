// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/check_options.hpp"

#include <fmt/format.h>

#include "services/contract/config_error.hpp"
#include "services/motion/ride_file.hpp"
#include "services/runtime/process/domain.hpp"

namespace stillhand::lab {
namespace {

void check_combinations(const LabOptions& options) {
  if ((options.protocol.motion == session::Motion::kRide) == options.ride.empty()) {
    throw ConfigError("--ride", options.ride.empty() ? "nothing" : options.ride.string(),
                      "a file with --motion ride, and no file without it");
  }
  if (options.who == Operator::kMouse && options.headless) {
    throw ConfigError("--operator", "mouse together with --headless", "a window for the mouse");
  }
  if (options.attach &&
      (options.undeclared_effect != 0 || options.subject != 0 || options.video ||
       options.who == Operator::kMouse || options.protocol.motion != session::Motion::kBandNoise)) {
    throw ConfigError("--attach",
                      "--undeclared-effect, --subject, --video, --operator or --motion with it",
                      "these as arguments of the services, which run already");
  }
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
  if (ride.length_s() < options.protocol.trial_s) {
    throw ConfigError(options.ride.string(), fmt::format("{:f} s of ride", ride.length_s()),
                      fmt::format("at least the --trial-seconds {:f}", options.protocol.trial_s));
  }
  return ride;
}

}  // namespace

AskedMotions check_options(const LabOptions& options) {
  session::plan(options.protocol);  // checks durations and road
  check_combinations(options);
  check_values(options);
  return rehearse(options.protocol, ride_of(options), options.config);
}

}  // namespace stillhand::lab

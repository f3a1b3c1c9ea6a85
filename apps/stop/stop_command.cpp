// SPDX-License-Identifier: Apache-2.0
#include "apps/stop/stop_command.hpp"

#include <memory>

#include "apps/stop/stop.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::stop {

void add_stop_command(command_line::Command& cli, int& status) {
  auto options = std::make_shared<StopOptions>();
  options->profiles = runtime::shipped("qos/profiles.xml");
  command_line::Command stop = cli.add_subcommand(
      "stop",
      "Emergency stop without a dashboard: the motor force goes to zero, the platform brakes, the\n"
      "session ends. It asks every session that a lab of this machine runs, and prints of each "
      "rig\n"
      "that its force is zero, and how long it took to reach it. Exit status 1 if one did not\n"
      "report it.\n"
      "Example: stillhand stop");
  stop.add_option("--domain", options->domain, "DDS domain of one session [all of this machine]")
      .between(0, 232);
  stop.add_option("--rig", options->rig, "number of one rig [all on the domain]");
  stop.add_option("--security", options->security,
                  "folder of keys (deploy/security/make.sh), for a session with keys")
      .check(settings::check_name);
  stop.add_option("--wait", options->wait_s, "longest wait for the rigs' answers [s]")
      .check(settings::number_between(2.0, 60.0));
  stop.add_option("--profiles", options->profiles, "file with the QoS profiles");
  stop.callback([options, &status] {
    const runtime::Stop interrupted;
    status = run_stop(*options, interrupted);
  });
}

}  // namespace stillhand::stop

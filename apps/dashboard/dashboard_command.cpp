// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/dashboard_command.hpp"

#include <memory>

#include "apps/dashboard/dashboard.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/shipped.hpp"

namespace stillhand::dashboard {

void add_dashboard_command(command_line::Command& cli, int& status) {
  auto options = std::make_shared<DashboardOptions>();
  options->server.port = 8340;
  options->bus.profiles = runtime::shipped("qos/profiles.xml");
  options->config = runtime::shipped("deploy/config");
  options->pages = runtime::shipped("dashboard");
  command_line::Command verb = cli.add_subcommand(
      "dashboard",
      "Serves a page for the browser that shows whether the control loop of a running session\n"
      "is healthy and, if not, where and since when. The dashboard is outside of every session:\n"
      "no session waits for it or ends with it. Ends with Ctrl-C.\n"
      "Example: stillhand dashboard --port 8340, then open http://127.0.0.1:8340/");
  verb.add_option("--port", options->server.port, "TCP port; 0: any free port");
  verb.add_option("--bind", options->server.address,
                  "address to listen on; an address other than loopback requires --token-file");
  verb.add_option("--token-file", options->token_file,
                  "file with a token, for watching and acting; a browser shows the token once, "
                  "as /?token=...")
      .check(settings::check_name);
  verb.add_option("--watch-token-file", options->watch_token_file,
                  "file with a second token, for people who watch: it shows everything and can do "
                  "nothing but an emergency stop")
      .check(settings::check_name);
  verb.add_option("--recording", options->recording,
                  "show this recording (MCAP) of a session instead of the bus")
      .check(settings::check_name);
  verb.add_flag("!--unblinded", options->blinded,
                "show the condition of a trial, and the motor force while a person tracks");
  verb.add_flag("--read-only", options->read_only,
                "no buttons; send nothing to a session or a recorder");
  verb.add_flag("!--no-real-time", options->real_time,
                "do not request SCHED_FIFO for the receiving threads");
  verb.add_option("--rig", options->rig, "rig that the page shows in full");
  verb.add_option("--domain", options->bus.domain, "DDS domain, 0 to 232");
  verb.add_option("--config", options->config,
                  "folder with dashboard.yaml and the settings of the services");
  verb.add_option("--profiles", options->bus.profiles, "QoS profiles");
  verb.add_option(
          "--security", options->bus.security,
          "folder of certificates (deploy/security/make.sh): the verb listens with the certificate "
          "of the tap\nand sends with that of the dashboard, unless --read-only is given [no "
          "security]")
      .check(settings::check_name);
  verb.callback([options, &status] {
    runtime::Stop stop;
    status = run_dashboard(*options, stop);
  });
}

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/dashboard_command.hpp"

#include <CLI/CLI.hpp>
#include <memory>

#include "apps/dashboard/dashboard.hpp"
#include "services/runtime/process/shipped.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::dashboard {

void add_dashboard_command(CLI::App& cli, int& status) {
  auto options = std::make_shared<DashboardOptions>();
  options->server.port = 8340;
  options->bus.profiles = runtime::shipped("qos/profiles.xml");
  options->config = runtime::shipped("deploy/config");
  options->pages = runtime::shipped("dashboard");
  CLI::App* verb = cli.add_subcommand(
      "dashboard",
      "A page for the browser that tells whether the control loop of a running session is "
      "healthy,\n"
      "and when not, where and since when. Listens from outside: no session waits for it or ends\n"
      "with it. Ends with Ctrl-C.\n"
      "Example: stillhand dashboard --port 8340, then open http://127.0.0.1:8340/");
  verb->add_option("--port", options->server.port, "TCP port; 0: any that is free")
      ->capture_default_str();
  verb->add_option("--bind", options->server.address,
                   "address to listen on; beyond loopback it wants --token-file")
      ->capture_default_str();
  verb->add_option("--token-file", options->token_file,
                   "file with a token that a browser has to show once, as /?token=...")
      ->check(settings::check_name);
  verb->add_option("--recording", options->recording,
                   "instead of the bus: what this MCAP file of a session holds")
      ->check(settings::check_name);
  verb->add_flag("!--unblinded", options->blinded,
                 "show a trial's condition, and the motor's force while a person tracks");
  verb->add_flag("--read-only", options->read_only,
                 "no buttons: asks nothing of a session or a recorder");
  verb->add_flag("!--no-real-time", options->real_time,
                 "do not ask for SCHED_FIFO for the threads that receive");
  verb->add_option("--rig", options->rig, "number of the rig")->capture_default_str();
  verb->add_option("--domain", options->bus.domain, "DDS domain, 0 to 232")->capture_default_str();
  verb->add_option("--config", options->config, "folder with dashboard.yaml and the services' own")
      ->capture_default_str();
  verb->add_option("--profiles", options->bus.profiles, "QoS profiles")->capture_default_str();
  verb->add_option(
          "--security", options->bus.security,
          "folder of certificates (deploy/security/make.sh): this verb listens with that of "
          "the tap and\nasks with that of the dashboard, which --read-only does without; "
          "none: no security")
      ->check(settings::check_name);
  verb->callback([options, &status] {
    runtime::Stop stop;
    status = run_dashboard(*options, stop);
  });
}

}  // namespace stillhand::dashboard

// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab_command.hpp"

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "apps/lab/lab.hpp"
#include "services/contract/config_error.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::lab {
namespace {

// What the command line says in words.
struct Words {
  std::string conditions = "A,B,C";
  std::string who = "simulated";
  std::string motion = "noise";
  bool ordinary = false;  // scheduling
  std::optional<std::string> road_class;
  std::optional<double> road_speed_m_s;
};

// Words that go with another one would be without effect without it.
void take_road(const Words& words, session::ProtocolOptions& protocol) {
  if (protocol.motion != session::Motion::kRoad && (words.road_class || words.road_speed_m_s)) {
    throw ConfigError(words.road_class ? "--road-class" : "--speed-m-s",
                      "it with --motion " + words.motion, "--motion road with it");
  }
  protocol.road_class = words.road_class.value_or(protocol.road_class);
  protocol.road_speed_m_s = words.road_speed_m_s.value_or(protocol.road_speed_m_s);
}

}  // namespace

void add_lab_command(CLI::App& cli, int& status) {
  auto options = std::make_shared<LabOptions>();
  auto words = std::make_shared<Words>();
  set_places(*options);

  CLI::App* lab = cli.add_subcommand(
      "lab",
      "A whole session, on this machine or on those of an inventory: every process over DDS,\n"
      "identification with the stick pegged,\n"
      "then one tracking trial a condition in blinded, shuffled order, recorded and evaluated.\n"
      "Example: stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --out "
      "run1");
  lab->add_option("--conditions", words->conditions,
                  "A stationary, B moving, C moving with cancellation; comma-separated")
      ->capture_default_str();
  lab->add_option("--trial-seconds", options->protocol.trial_s, "length of a tracking trial [s]")
      ->capture_default_str();
  lab->add_option("--identify-seconds", options->protocol.identify_s,
                  "length of the pegged trial [s]; the paper's is 120")
      ->capture_default_str();
  lab->add_option("--seed", options->protocol.seed, "seed of everything random")
      ->check(session::check_seed)
      ->capture_default_str();
  lab->add_option("--out", options->out, "folder of recording, results and logs")->required();
  lab->add_flag("--headless", options->headless, "no window");
  lab->add_flag("--video", options->video, "write the tracking screen to DIR/screen.avi");
  lab->add_option("--operator", words->who, "who tracks: simulated, or a person with the mouse")
      ->check(CLI::IsMember({"simulated", "mouse"}))
      ->capture_default_str();
  lab->add_option("--motion", words->motion,
                  "platform motion in B and C: noise (the paper's), road (ISO 8608), ride")
      ->check(CLI::IsMember({"noise", "road", "ride"}))
      ->capture_default_str();
  lab->add_option("--ride", options->ride,
                  "recorded ride for --motion ride: CSV with a_y [m/s^2], or .mcap")
      ->check(settings::check_name);
  lab->add_option("--road-class", words->road_class,
                  "road for --motion road: A (very good) to H, by ISO 8608 [B]");
  lab->add_option("--speed-m-s", words->road_speed_m_s,
                  "speed of the vehicle on it [m/s], 0.5 to 70 [20]");
  lab->add_option("--model", options->model,
                  "control model that condition C uses instead of the session's own, as "
                  "`stillhand close-the-loop` and `stillhand control-model` write it")
      ->check(settings::check_name);
  lab->add_option("--undeclared-effect", options->undeclared_effect,
                  "seed of an effect that only the rig knows of, sealed until the results are "
                  "written; 0: none")
      ->check(session::check_seed);
  CLI::Option* domain = lab->add_option("--domain", options->domain, "DDS domain, 0 to 232");
  domain->capture_default_str();
  CLI::Option* inventory = lab->add_option(
      "--inventory", options->inventory,
      "the lab's machines and which service runs where, as for `stillhand deploy`; it "
      "names the domain and the keys");
  inventory->excludes(domain)->check(settings::check_name);
  lab->add_option("--security", options->security,
                  "folder of certificates (deploy/security/make.sh), each process's own and this "
                  "verb's; none: no security")
      ->excludes(inventory)
      ->check(settings::check_name);
  lab->add_option("--rig", options->rig, "number of the rig on the bus")->capture_default_str();
  lab->add_option("--match-seconds", options->match_s,
                  "patience until every endpoint has matched [s]")
      ->capture_default_str();
  lab->add_option("--profiles", options->profiles, "QoS profiles")->capture_default_str();
  lab->add_option("--config", options->config, "folder with the settings of each service")
      ->capture_default_str();
  lab->add_flag("--attach", options->attach,
                "start no service: conduct those that run already, as systemd starts them with "
                "--one-session, and fetch their recording");
  lab->add_flag("--wait-for-start", options->wait_for_start,
                "each trial waits until somebody presses Start on the dashboard");
  recording::add_keep_options(*lab, options->keep);
  lab->add_flag("--no-real-time", words->ordinary, "do not ask for real-time priority");
  lab->callback([options, words, &status] {
    options->protocol.conditions = session::parse_conditions(words->conditions);
    options->who = words->who == "mouse" ? Operator::kMouse : Operator::kSimulated;
    options->protocol.motion = words->motion == "road"   ? session::Motion::kRoad
                               : words->motion == "ride" ? session::Motion::kRide
                                                         : session::Motion::kBandNoise;
    take_road(*words, options->protocol);
    options->real_time = !words->ordinary;
    runtime::Stop stop;
    status = run_lab(*options, stop);
  });
}

}  // namespace stillhand::lab

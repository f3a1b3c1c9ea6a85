// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/lab_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "apps/lab/arms_file.hpp"
#include "apps/lab/lab.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::lab {
namespace {

// Options whose texts are not the values of LabOptions.
struct LabArguments {
  std::string conditions = "A,B,C";
  std::string who = "simulated";
  std::string motion = "noise";
  std::vector<std::filesystem::path> arms;
  bool ordinary = false;  // scheduling
  std::string close;
  std::vector<std::string> rig;  // its number, what it is made of, or both
  std::optional<std::string> road_class;
  std::optional<double> road_speed_m_s;
  std::string identify;
  std::filesystem::path plan;
  std::optional<double> perturb_period_s;
  std::optional<std::string> task;
  bool held = false;
  bool swapped = false;
};

// The options of the perturbed trial have no effect without --identify: they are refused.
void take_perturbation(const LabArguments& arguments, LabOptions& options) {
  if (arguments.identify.empty()) {
    const char* const given = arguments.perturb_period_s ? "--perturb-period-s"
                              : arguments.task           ? "--task"
                              : arguments.held           ? "--held-stick"
                              : arguments.swapped        ? "--swap-lines"
                                                         : nullptr;
    if (given == nullptr) return;
    throw ConfigError(given, "it without --identify", "it with --identify admittance,feedthrough");
  }
  options.protocol.conditions = {session::Condition::kP};
  options.protocol.perturb_period_s = arguments.perturb_period_s.value_or(20.0);
  options.protocol.stick_held = arguments.held;
  options.protocol.perturb_swapped = arguments.swapped;
  options.task = arguments.task.value_or(options.task);
}

// An option of the road has no effect without --motion road: it is refused.
void take_road(const LabArguments& arguments, session::ProtocolOptions& protocol) {
  if (protocol.motion != motion::MotionKind::kRoad &&
      (arguments.road_class || arguments.road_speed_m_s)) {
    throw ConfigError(arguments.road_class ? "--road-class" : "--speed-m-s",
                      "it with --motion " + arguments.motion, "it with --motion road alone");
  }
  protocol.road_class = arguments.road_class.value_or(protocol.road_class);
  protocol.road_speed_m_s = arguments.road_speed_m_s.value_or(protocol.road_speed_m_s);
}

// "2", "simulated", "devices", or a file; as many of them as are given.
void take_rig(const std::vector<std::string>& arguments, LabOptions& options) {
  const auto is_number = [](const std::string& word) {
    return !word.empty() && word.find_first_not_of("0123456789") == std::string::npos;
  };
  if (std::ranges::count_if(arguments, is_number) > 1 ||
      std::ranges::count_if(arguments, std::not_fn(is_number)) > 1) {
    throw ConfigError("--rig", fmt::format("{}", fmt::join(arguments, " and ")),
                      "at most one number and one of simulated, devices or a file");
  }
  for (const std::string& word : arguments) {
    if (is_number(word)) {
      const auto [end, error] =
          std::from_chars(word.data(), word.data() + word.size(), options.rig);
      if (error == std::errc()) continue;
    } else if (word == "simulated") {
      options.devices.clear();
      continue;
    } else if (word == "devices") {
      options.devices = options.config / "devices.yaml";
      continue;
    } else if (std::filesystem::is_regular_file(word)) {
      options.devices = std::filesystem::absolute(word);
      continue;
    }
    throw ConfigError("--rig", word,
                      "a number, simulated, devices, or a file in the form of devices.yaml");
  }
}

// The trials and the person or model that tracks.
void add_trial_options(command_line::Command& lab, LabOptions& options, LabArguments& arguments) {
  lab.add_option("--conditions", arguments.conditions,
                 "comma-separated: " + session::known_conditions(session::kLabConditions));
  lab.add_option("--arms", arguments.arms,
                 "for the condition scheduled: the person's arm, relaxed and holding; two files of "
                 "`stillhand identify --admittance --json`, comma-separated")
      .delimiter(',');
  lab.add_option("--trial-seconds", options.protocol.trial_s, "length of a tracking trial [s]");
  lab.add_option("--identify-seconds", options.protocol.identify_s,
                 "length of the pegged trial [s]; the paper's is 120");
  lab.add_option(
         "--identify", arguments.identify,
         "admittance,feedthrough: instead of the conditions, one trial in which motor and platform "
         "move the free stick together; `stillhand identify --admittance` evaluates it")
      .excludes(lab.get_option("--conditions"))
      .one_of({"admittance,feedthrough"});
  lab.add_option("--plan", arguments.plan,
                 "instead of the conditions, the pegged trial alone in the motion that `stillhand "
                 "plan-run` planned: its plan.json")
      .excludes(lab.get_option("--conditions"))
      .excludes(lab.get_option("--identify"))
      .excludes(lab.get_option("--identify-seconds"))
      .check(settings::check_name);
  lab.add_option("--perturb-period-s", arguments.perturb_period_s,
                 "with --identify: period of both multisines [s]; the trial holds a whole number "
                 "of periods, five or more [20]");
  lab.add_option("--task", arguments.task, "with --identify: task of the simulated person [hold]")
      .one_of({"hold", "relax", "give-way"});
  lab.add_flag("--held-stick", arguments.held,
               "with --identify: the stick stays on its peg; for `identify --admittance --held`");
  lab.add_flag("--swap-lines", arguments.swapped,
               "with --identify: motor and platform exchange their frequencies; for `identify "
               "--admittance --swapped`");
  lab.add_option("--seed", options.protocol.seed, "seed of everything random")
      .check(session::check_seed);
  lab.add_option("--operator", arguments.who,
                 "who tracks: a simulated subject, or a person's mouse or gamepad")
      .one_of({"simulated", "mouse", "gamepad"});
  lab.add_option("--gamepad", options.gamepad,
                 "for --operator gamepad: input device such as /dev/input/event5")
      .check(settings::check_name);
  lab.add_option("--subject", options.subject,
                 "number of the simulated subject that `stillhand study --seed` draws; 0: the one "
                 "in the settings")
      .between(0, 10000);
  lab.add_flag("--wait-for-start", options.wait_for_start,
               "each trial waits until a person presses Start on the dashboard");
}

void add_motion_options(command_line::Command& lab, LabOptions& options, LabArguments& arguments) {
  lab.add_option("--motion", arguments.motion,
                 "platform motion in B and C: noise (the paper's), road (ISO 8608), or ride")
      .one_of({"noise", "road", "ride"});
  lab.add_option("--ride", options.ride,
                 "recorded ride for --motion ride: CSV with a_y [m/s^2], or .mcap")
      .check(settings::check_name);
  lab.add_option("--road-class", arguments.road_class,
                 "road for --motion road: ISO 8608 class, A (very good) to H [B]");
  lab.add_option("--speed-m-s", arguments.road_speed_m_s,
                 "speed of the vehicle on that road [m/s], 0.5 to 70 [20]");
  lab.add_option("--vehicle", options.vehicle,
                 "in B and C the stick drives a vehicle that moves the platform: first_order, "
                 "second_order, excavator, wheelchair, aircraft_roll, or settings (vehicle.yaml of "
                 "--config); a growing oscillation ends the trial")
      .check(settings::check_name)
      .excludes(lab.get_option("--motion"));
  command_line::Option canceller =
      lab.add_option("--canceller", options.canceller,
                     "canceller of condition C: now (1 kHz), or paper (50 Hz, "
                     "after the paper's low-pass of 10 Hz, one sample late)");
  canceller.one_of({"now", "paper"});
  lab.add_option("--model", options.model,
                 "control model for condition C, instead of the session's own; `stillhand "
                 "close-the-loop` and `stillhand control-model` write such a file")
      .excludes(canceller)
      .check(settings::check_name);
  lab.add_option("--close", arguments.close,
                 "live: if the model no longer holds in the trial of C, the pause behind it "
                 "identifies and diagnoses again, and C runs again, as C+ if that leaves less and "
                 "the experimenter agrees")
      .one_of({"live"});
  lab.add_option("--undeclared-effect", options.undeclared_effect,
                 "seed of an effect that only the rig knows; it stays sealed until the results "
                 "are written; 0: no effect")
      .check(session::check_seed);
}

// What the session writes and shows.
void add_output_options(command_line::Command& lab, LabOptions& options) {
  lab.add_option("--out", options.out,
                 "folder for the recording, the results and the logs; an earlier session stays in "
                 "OUT/earlier-1")
      .required();
  lab.add_flag("--headless", options.headless, "open no window");
  lab.add_flag("--video", options.video, "write the tracking screen to OUT/screen.avi");
  recording::add_keep_options(lab, options.keep);
}

// The machines, the bus and the services.
void add_bus_options(command_line::Command& lab, LabOptions& options, LabArguments& arguments) {
  command_line::Option domain = lab.add_option("--domain", options.domain, "DDS domain, 0 to 232");
  command_line::Option inventory = lab.add_option(
      "--inventory", options.inventory,
      "file with the lab's machines and the services of each, the same as for `stillhand "
      "deploy`; it names the domain and the keys");
  inventory.excludes(domain).check(settings::check_name);
  lab.add_option("--security", options.security,
                 "folder with the certificate of each process and of this verb "
                 "(deploy/security/make.sh makes it); without: no security")
      .excludes(inventory)
      .check(settings::check_name);
  lab.add_option("--rig", arguments.rig,
                 "the rig's parts: simulated; devices (those of devices.yaml in --config; run "
                 "`stillhand calibrate` first); or another file like devices.yaml [simulated]. "
                 "A number is the rig's number on the bus [1]. Both may be given")
      .repeatable();
  lab.add_option("--match-seconds", options.match_s,
                 "longest wait until all processes have found each other [s]");
  lab.add_option("--profiles", options.profiles, "file with the QoS profiles");
  lab.add_option("--config", options.config, "folder with the settings of each service");
  lab.add_flag("--attach", options.attach,
               "start no service: conduct the services that systemd started with --one-session, "
               "and fetch their recording")
      .excludes(lab.get_option("--canceller"));  // their settings say it
  lab.add_option("--stop-key", options.stop_key,
                 "input device, such as /dev/input/event3: each of its keys is an emergency stop, "
                 "and so is its loss");
  lab.add_flag("--no-real-time", arguments.ordinary, "do not ask for real-time priority");
  lab.add_flag("--trace-switches", options.traces_switches,
               "keep the kernel's trace of which program each processor runs, so that `stillhand "
               "misses --why` names it; needs the right to write tracefs, as root has it");
}

void take_arguments(const LabArguments& arguments, LabOptions& options) {
  options.protocol.conditions = session::parse_conditions(arguments.conditions);
  const bool scheduled =
      std::ranges::find(options.protocol.conditions, session::Condition::kScheduled) !=
      options.protocol.conditions.end();
  if (scheduled == arguments.arms.empty()) {
    throw ConfigError("--arms", arguments.arms.empty() ? "nothing" : "files",
                      "two files with the condition scheduled, and none without it");
  }
  if (scheduled) options.protocol.arms = schedule_values(arguments.arms);
  options.who = arguments.who == "simulated" ? Operator::kSimulated : Operator::kMouse;
  if ((arguments.who == "gamepad") == options.gamepad.empty()) {
    throw ConfigError("--gamepad", options.gamepad.empty() ? "nothing" : options.gamepad.string(),
                      "a device with --operator gamepad, and none without it");
  }
  options.protocol.motion = arguments.motion == "road"   ? motion::MotionKind::kRoad
                            : arguments.motion == "ride" ? motion::MotionKind::kRide
                                                         : motion::MotionKind::kBandNoise;
  take_road(arguments, options.protocol);
  take_perturbation(arguments, options);
  take_rig(arguments.rig, options);
  options.real_time = !arguments.ordinary;
  options.close_live = !arguments.close.empty();
  if (!arguments.plan.empty()) take_plan(arguments.plan, options);
}

// What is left is what people use first.
void group_options(command_line::Command& lab) {
  lab.group("Motion and vehicle",
            {"--motion", "--ride", "--road-class", "--speed-m-s", "--vehicle"});
  lab.group("Canceller and model",
            {"--canceller", "--model", "--arms", "--close", "--undeclared-effect"});
  lab.group("Trials", {"--identify-seconds", "--subject", "--gamepad", "--wait-for-start",
                       "--video", "--match-seconds", "--stop-key"});
  lab.group("Identification of arm and feedthrough at once",
            {"--identify", "--perturb-period-s", "--task", "--held-stick", "--swap-lines"});
  lab.group("Machines and bus", {"--domain", "--inventory", "--security", "--profiles", "--attach",
                                 "--no-real-time", "--trace-switches"});
}

}  // namespace

void add_lab_command(command_line::Command& cli, int& status) {
  auto options = std::make_shared<LabOptions>();
  auto arguments = std::make_shared<LabArguments>();
  set_places(*options);
  command_line::Command lab = cli.add_subcommand(
      "lab",
      "Runs a whole session, on this machine or on the machines of an inventory. The verb starts\n"
      "every process and identifies the feedthrough with the stick fixed. Then it runs one\n"
      "tracking trial for each condition, in blinded and shuffled order. It records everything "
      "and\n"
      "computes the results from the recording.\n"
      "Example: stillhand lab --conditions A,B,C --trial-seconds 20 --seed 1 --headless --out "
      "run1");
  add_trial_options(lab, *options, *arguments);
  add_motion_options(lab, *options, *arguments);
  add_output_options(lab, *options);
  add_bus_options(lab, *options, *arguments);
  group_options(lab);
  lab.callback([options, arguments, &status] {
    take_arguments(*arguments, *options);
    runtime::Stop stop;
    status = run_lab(*options, stop);
  });
}

}  // namespace stillhand::lab

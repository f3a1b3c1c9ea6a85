// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/calibrate_command.hpp"

#include <CLI/CLI.hpp>
#include <map>
#include <memory>
#include <string>

#include "apps/calibrate/calibrate.hpp"
#include "apps/calibrate/hand_off_steps.hpp"
#include "apps/calibrate/platform_steps.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::calibrate {
namespace {

/// calibration.yaml keeps it.
std::string check_short(const std::string& word) {
  constexpr std::size_t kMost = 100;
  const bool one_line = word.find_first_of("\r\n") == std::string::npos;
  return word.size() <= kMost && one_line ? ""
                                          : "got a long text, want at most 100 bytes in one line";
}

void add_measures(CLI::App& calibrate, CalibrateOptions& options) {
  calibrate.add_option("--seconds", options.seconds, "time of each step [s]")
      ->check(CLI::Range(0.1, 60.0))
      ->capture_default_str();
  calibrate
      .add_option("--tolerance", options.tolerance,
                  "largest distance from the straight line, and largest drift, as a share of the "
                  "largest quantity [-]")
      ->check(CLI::Range(0.0001, 0.5))
      ->capture_default_str();
  calibrate
      .add_option("--motion", options.motion_m,
                  "platform: largest distance from where it stands [m]")
      ->check(CLI::Range(0.001, 0.1))
      ->capture_default_str();
  calibrate
      .add_option("--periods", options.periods, "platform: periods of 2 s that are measured [-]")
      ->check(CLI::Range(2, 200))
      ->capture_default_str();
  calibrate
      .add_option("--push", options.push_n,
                  "check: weight on the cord, and the motor's largest force [N]")
      ->check(CLI::Range(0.2, 5.0))
      ->capture_default_str();
  calibrate.add_option("--step", options.step_m, "check: step of the platform [m]")
      ->check(CLI::Range(0.0005, 0.01))
      ->capture_default_str();
}

}  // namespace

void add_calibrate_command(CLI::App& cli, int& status) {
  auto options = std::make_shared<CalibrateOptions>();
  auto signal = std::make_shared<std::string>();
  CLI::App* calibrate = cli.add_subcommand(
      "calibrate",
      "Calibrates a sensor of a rig of devices, by steps that a person makes: zero, gain, sign,\n"
      "noise, and what the other sensors see. No motor is armed. \"platform\" moves the platform "
      "and\n"
      "identifies its lag and bandwidth. \"check\" checks travel, signs and scales with the hand "
      "off;\n"
      "it arms the motor for two pushes of --push. Writes the result into sensing.yaml and\n"
      "calibration.yaml of --config; a session with devices asks for it.\n"
      "Example: stillhand calibrate force --config hall --person kl --known 0,5,10,-5,-10");
  calibrate->add_option("signal", *signal, "force, acceleration, angle, platform or check")
      ->required()
      ->check(CLI::IsMember({"force", "acceleration", "angle", "platform", "check"}));
  calibrate
      ->add_option("--config", options->config,
                   "your folder of settings, with devices.yaml; a copy of deploy/config to begin "
                   "with")
      ->required()
      ->check(settings::check_name);
  calibrate->add_option("--person", options->person, "who does it")
      ->required()
      ->check(settings::check_name)
      ->check(check_short);
  calibrate->add_option("--sensor", options->sensor, "number that is printed on the sensor")
      ->check(check_short);
  calibrate->add_option(
      "--known", options->known,
      "quantities that act, + right, in N or kg, m/s^2 or g, rad or deg; the first one comes again "
      "at the end [0,5,10,-5,-10 N; 0,1g,-1g; 0,10deg,20deg,-10deg,-20deg]");
  add_measures(*calibrate, *options);
  calibrate->callback([options, signal, &status] {
    const std::map<std::string, device_rig::CalibratedSignal> signals{
        {"force", device_rig::CalibratedSignal::kForce},
        {"acceleration", device_rig::CalibratedSignal::kAcceleration},
        {"angle", device_rig::CalibratedSignal::kAngle}};
    const runtime::Stop interrupted;
    if (*signal == "platform") {
      status = run_calibrate_platform(*options, interrupted);
      return;
    }
    if (*signal == "check") {
      status = run_hand_off_check(*options, interrupted);
      return;
    }
    options->signal = signals.at(*signal);
    status = run_calibrate(*options, interrupted);
  });
}

}  // namespace stillhand::calibrate

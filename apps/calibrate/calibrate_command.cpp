// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/calibrate_command.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/calibrate/ask.hpp"
#include "apps/calibrate/calibrate.hpp"
#include "apps/calibrate/hand_off_steps.hpp"
#include "apps/calibrate/platform_steps.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::calibrate {
namespace {

constexpr std::array<std::string_view, 5> kOrder{"force", "acceleration", "angle", "platform",
                                                 "check"};

/// calibration.yaml keeps it.
std::string check_short(const std::string& word) {
  constexpr std::size_t kMost = 100;
  const bool one_line = word.find_first_of("\r\n") == std::string::npos;
  return word.size() <= kMost && one_line ? ""
                                          : "got a long text, want at most 100 bytes in one line";
}

void add_measures(command_line::Command& calibrate, CalibrateOptions& options) {
  calibrate
      .add_option("--seconds", options.seconds,
                  "force, acceleration, angle: time for which each step is read [s]")
      .check(settings::number_between(0.1, 60.0));
  calibrate
      .add_option("--tolerance", options.tolerance,
                  "force, acceleration, angle: largest distance from the straight line, and "
                  "largest drift, as a share of the largest quantity; more is refused [-]")
      .check(settings::number_between(0.0001, 0.5));
  calibrate
      .add_option("--motion", options.motion_m,
                  "platform: largest distance from where it stands [m]")
      .check(settings::number_between(0.001, 0.1));
  calibrate
      .add_option("--periods", options.periods, "platform: periods of 2 s that are measured [-]")
      .between(2, 200);
  calibrate
      .add_option("--push", options.push_n,
                  "check: weight that you hang on the cord, and largest force of the motor [N]")
      .check(settings::number_between(0.2, 5.0));
  calibrate.add_option("--step", options.step_m, "check: step of the platform [m]")
      .check(settings::number_between(0.0005, 0.01));
}

void say_following(const std::string& signal, const CalibrateOptions& options) {
  const auto* at = std::ranges::find(kOrder, signal);
  const std::string config = " --config " + report::quoted_for_shell(options.config);
  report::say_next(at + 1 == kOrder.end()
                       ? "stillhand lab --rig devices" + config
                       : fmt::format("stillhand calibrate {}{} --person {}", *(at + 1), config,
                                     report::quoted_for_shell(options.person)));
}

}  // namespace

void add_calibrate_command(command_line::Command& cli, int& status) {
  auto options = std::make_shared<CalibrateOptions>();
  auto signal = std::make_shared<std::string>();
  command_line::Command calibrate = cli.add_subcommand(
      "calibrate",
      "Calibrates the devices of a rig (devices.yaml of --config). It says what to do, step by "
      "step,\nand waits for Enter.\n"
      "  force         hang weights on a cord from the grip: zero, gain, noise of the load cell\n"
      "  acceleration  turn the accelerometer in gravity: the same of the accelerometer\n"
      "  angle         hold the stick at known angles: the same of the encoder\n"
      "  platform      the platform MOVES, nobody on it: its lag and bandwidth\n"
      "  check         the motor PUSHES twice with --push, the platform moves by --step, hands "
      "off:\n"
      "                travel, signs and scales of everything together; after the others\n"
      "The first three arm no motor. The result goes into sensing.yaml and calibration.yaml of "
      "--config;\na session with devices does not begin without it.\n"
      "Example: stillhand calibrate force --config hall --person kl --known 0,5,10,-5,-10");
  calibrate.add_option("signal", *signal, "what to calibrate, as above")
      .required()
      .one_of({kOrder.begin(), kOrder.end()});
  calibrate
      .add_option("--config", options->config,
                  "your folder of settings, with devices.yaml; to begin with, copy the folder "
                  "that `stillhand lab --help` names at --config")
      .required()
      .check(settings::check_name);
  calibrate
      .add_option("--person", options->person,
                  "name or initials of who does it; calibration.yaml keeps them")
      .required()
      .check(settings::check_name)
      .check(check_short);
  calibrate
      .add_option("--sensor", options->sensor,
                  "serial number that is printed on the sensor; calibration.yaml keeps it")
      .check(check_short);
  calibrate.add_option(
      "--known", options->known,
      "force, acceleration, angle: quantities of the steps, positive to the right, three or more "
      "to both sides of 0; the first comes again at the end. force in N, or 1kg for its weight; "
      "acceleration in m/s^2, or 1g; angle in rad, or 10deg [force 0,5,10,-5,-10; acceleration "
      "0,1g,-1g; angle 0,10deg,20deg,-10deg,-20deg]");
  add_measures(calibrate, *options);
  calibrate.callback([options, signal, &status] {
    want_terminal();
    const runtime::Stop interrupted;
    if (*signal == "platform") {
      status = run_calibrate_platform(*options, interrupted);
    } else if (*signal == "check") {
      status = run_hand_off_check(*options, interrupted);
    } else {
      // kOrder begins with the signals.
      const auto place = std::ranges::find(kOrder, *signal) - kOrder.begin();
      options->signal = device_rig::kCalibratedSignals.at(static_cast<std::size_t>(place));
      status = run_calibrate(*options, interrupted);
    }
    if (status == 0) say_following(*signal, *options);
  });
}

}  // namespace stillhand::calibrate

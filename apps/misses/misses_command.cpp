// SPDX-License-Identifier: Apache-2.0
#include "apps/misses/misses_command.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "apps/libraries/session/clock_line.hpp"
#include "apps/libraries/session/misses.hpp"
#include "apps/libraries/session/misses_json.hpp"
#include "apps/libraries/session/session_recording.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/remark.hpp"

namespace stillhand::misses {
namespace {

struct Arguments {
  std::string recording;
  double least_ms = 5.0;
  bool why = false;
  std::filesystem::path json, picture;
};

std::string when(const session::Miss& miss) {
  if (miss.trial < 0) return fmt::format("no trial, {:.3f} s", miss.from_s);
  const std::string trial = miss.pegged ? "identification" : fmt::format("trial {}", miss.trial);
  return fmt::format("{} at {:.3f} s", trial, miss.trial_s);
}

std::string json_of(const std::vector<session::Miss>& misses) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const session::Miss& miss : misses) list.push_back(session::json_of(miss));
  return list.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

double seconds_from(const session::Miss& miss, std::int64_t at_ns) {
  return 1e-9 * static_cast<double>(at_ns - miss.from_ns);
}

// The motor force around the longest one while the motor acted; if it never did, around the
// longest.
report::Figure figure_of(const session::SessionRecording& session,
                         const std::vector<session::Miss>& misses) {
  const auto worst = std::ranges::max_element(misses, {}, [](const session::Miss& miss) {
    return std::pair(miss.force_before_n > 0.0, miss.late_s);
  });
  report::Panel force{.title = when(*worst) + ": " + session::what_happened(*worst),
                      .x = {.label = "time after the silence began [s]", .low = -0.5, .high = 2.0},
                      .y = {.label = "motor force [N]"}};
  report::Series acted{.label = "acted", .colour = report::Colour::kConditionC};
  const session::ClockLine rig(session.clock_offsets, "rig");
  for (const auto& truth : session.rig_truths) {
    const double t_s = seconds_from(*worst, rig.on_experiments_clock(truth.stamp_ns()));
    if (t_s < -0.5 || t_s > 2.0) continue;
    acted.x.push_back(t_s);
    acted.y.push_back(truth.motor_force_n());
  }
  report::Series asked{.label = "asked for by the prediction",
                       .kind = report::Kind::kDottedLine,
                       .colour = report::Colour::kTarget};
  const session::ClockLine cancellation(session.clock_offsets, "cancellation");
  for (const auto& command : session.motor_commands) {
    const double t_s = seconds_from(*worst, cancellation.on_experiments_clock(command.stamp_ns()));
    if (t_s < -0.5 || t_s > 2.0) continue;
    asked.x.push_back(t_s);
    asked.y.push_back(-command.predicted_force_n());
  }
  force.series = {std::move(asked), std::move(acted)};
  force.reference_lines = {
      {report::Direction::kVertical, 0.0, "", report::Colour::kWarning},
      {report::Direction::kVertical, worst->late_s, fmt::format("{:.0f} ms", 1e3 * worst->late_s),
       report::Colour::kWarning}};
  return {.name = "misses", .panels = {std::move(force)}};
}

int run(const Arguments& arguments) {
  report::ResultFiles files({{"--json", arguments.json}, {"--picture", arguments.picture}},
                            {arguments.recording});
  const session::SessionRecording session = session::read_session(arguments.recording);
  if (session.raw_samples.empty()) {
    throw ConfigError(arguments.recording, "no sample of a rig", "the recording of a session");
  }
  const auto misses = session::misses_in(session, 1e-3 * arguments.least_ms);
  for (const session::Miss& miss : misses) {
    fmt::print("{:<27} {}{}\n", when(miss), session::what_happened(miss),
               miss.waited.empty() ? "" : fmt::format("; {} waited", fmt::join(miss.waited, ", ")));
    if (!arguments.why) continue;
    fmt::print("{:27} {}\n", "",
               miss.why.empty() ? "why is not known" : miss.process + " " + miss.why);
  }
  if (misses.empty()) {
    fmt::print("no process was late by {} ms or more\n", arguments.least_ms);
  }
  if (files.wants("--json")) files.set("--json", json_of(misses));
  if (files.wants("--picture")) {
    if (misses.empty()) throw ConfigError("--picture", "no miss to draw", "a smaller --least-ms");
    const std::vector<report::Figure> figures{figure_of(session, misses)};
    files.set("--picture", report::draw(figures).front().svg);
  }
  files.publish();
  if (!misses.empty()) {
    report::say_next("stillhand dashboard --recording " +
                     report::quoted_for_shell(arguments.recording) +
                     ", where N jumps to the next one");
  }
  if (!session.damage.empty()) {
    runtime::remark(fmt::format("{}: damaged in {} place{}, first: {}; `stillhand info` lists them",
                                arguments.recording, session.damage.size(),
                                session.damage.size() == 1 ? "" : "s", session.damage.front()));
  }
  return 0;
}

}  // namespace

void add_misses_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  command_line::Command verb = cli.add_subcommand(
      "misses",
      "Lists the processes that were late in a recorded session: which process, when, for how "
      "long,\nwhich other processes waited for it, and what the motor force did.\nExample: "
      "stillhand misses run1/session.mcap --picture late.svg");
  verb.add_option("FILE", arguments->recording, "recording of a session (MCAP)").required();
  verb.add_option("--least-ms", arguments->least_ms, "shortest lateness that is listed [ms]")
      .check(settings::number_between(1.0, 1e4));
  verb.add_flag("--why", arguments->why,
                "also what the kernel knows: no processor, a signal, work, memory from a disk");
  verb.add_option("--json", arguments->json, "write the same as JSON to this file");
  verb.add_option("--picture", arguments->picture,
                  "SVG file: the motor force around the longest lateness in which the motor acted");
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::misses

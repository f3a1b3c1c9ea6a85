// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/recorder_commands.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <stdexcept>

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/result_files.hpp"
#include "apps/libraries/session/lateness_channels.hpp"
#include "apps/recordings/export.hpp"
#include "apps/recordings/info.hpp"
#include "apps/recordings/recover.hpp"
#include "apps/recordings/ros2_bag.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/recording/csv.hpp"
#include "services/core/recording/mcap/compression.hpp"
#include "services/core/recording/mcap/mcap_loss.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/remark.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::recordings {
namespace {

// A verb about one recording, which it names first.
command_line::Command file_verb(command_line::Command& cli, std::string& recording,
                                const std::string& name, const std::string& description) {
  command_line::Command verb = cli.add_subcommand(name, description);
  verb.add_option("FILE", recording, "recording (MCAP)").required();
  return verb;
}

struct InfoArguments {
  std::string recording;
  std::filesystem::path json;
};

// Of damage, of a session, of what another program recorded.
const char* next_verb(const RecordingInfo& info) {
  if (!info.damage.empty()) return "recover";
  const bool session = std::any_of(info.topics.begin(), info.topics.end(),
                                   [](const TopicInfo& each) { return each.lost_ticks; });
  return session ? "misses" : "identify";
}

int run_info(const InfoArguments& arguments) {
  report::ResultFiles files({{"--json", arguments.json}}, {arguments.recording});
  OpenRecording recording(arguments.recording);
  const RecordingInfo info = info_of(recording);
  if (files.wants("--json")) files.set_json("--json", info_json(info));
  files.publish();
  std::fputs(info_text(info).c_str(), stdout);
  recording.report_loss(info.messages);
  report::say_next(fmt::format("stillhand {} {}", next_verb(info),
                               report::quoted_for_shell(arguments.recording)));
  return 0;
}

void add_info(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<InfoArguments>();
  command_line::Command verb =
      file_verb(cli, arguments->recording, "info",
                "Prints what a recording holds: topics, types, messages, rates, lost ticks, "
                "QoS,\nmetadata, damage. Reads the whole file and checks every checksum. If a "
                "crash left the file\nopen, the verb reads what is there and prints what is "
                "lost.\nExample: stillhand info demo/session.mcap --json info.json");
  verb.add_option("--json", arguments->json, "write the same as JSON to this file");
  verb.callback([arguments, &status] { status = run_info(*arguments); });
}

int run_verify(const std::string& path) {
  OpenRecording recording(path);
  std::uint64_t messages = 0;
  check(recording.reader.verify([&](const recording::MessageView&) { ++messages; }));
  const auto& damage = recording.reader.damage();
  const bool being_written = recording.source.being_written();
  if (damage.empty() && !being_written) {
    fmt::print("{}: whole; {} messages, every checksum is right\n", path, messages);
    recording.report_loss(messages);
    return 0;
  }
  std::fputs(damage_text(damage).c_str(), stdout);
  recording.report_loss(messages);
  if (!being_written) report::say_next("stillhand recover " + report::quoted_for_shell(path));
  return 1;
}

void add_verify(command_line::Command& cli, int& status) {
  auto path = std::make_shared<std::string>();
  command_line::Command verb = file_verb(
      cli, *path, "verify",
      "Reads the whole recording, checks every checksum and lists each finding with its place.\n"
      "Exit status 1 when the file is damaged, cut off or still being written.\n"
      "Example: stillhand verify demo/session.mcap");
  verb.callback([path, &status] { status = run_verify(*path); });
}

struct RecoverArguments {
  std::string recording;
  RecoverOptions options;
  std::string compression = "zstd";
};

int run_recover(RecoverArguments arguments) {
  runtime::Stop stop;
  arguments.options.stopped = [&stop] { return stop.requested(); };
  arguments.options.compression =
      *recording::compression_of(arguments.compression == "none" ? "" : arguments.compression);
  const Recovered result = recover(arguments.recording, arguments.options);
  if (result.was_whole) {
    fmt::print("{}: whole; nothing to recover\n", arguments.recording);
    return 0;
  }
  for (const std::string& finding : result.findings) fmt::print("{}\n", finding);
  fmt::print("{} messages recovered into {}; {} of the old file lost\n", result.messages,
             result.out, recording::byte_count(result.lost_bytes));
  if (result.attachments > 0) {
    fmt::print("{} attachments are in the old file only\n", result.attachments);
  }
  if (!result.kept.empty()) fmt::print("the old file is kept as {}\n", result.kept);
  report::say_next("stillhand info " + report::quoted_for_shell(result.out));
  return 0;
}

void add_recover(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<RecoverArguments>();
  command_line::Command verb =
      file_verb(cli, arguments->recording, "recover",
                "Copies what is readable in a cut-off or damaged recording into a new file, and "
                "prints\nwhat is lost. With --out the old file stays as it is. Without --out the "
                "new file takes\nthe name of the old one, which is kept as FILE.damaged. The new "
                "file appears when it is\ncomplete and on the disk. If the recording is whole, "
                "nothing is written.\nExample: stillhand recover crashed.mcap --out whole.mcap");
  verb.add_option("--out", arguments->options.out, "file to write; it must not exist yet");
  verb.add_option("--compression", arguments->compression,
                  "compression of the chunks: zstd, lz4 or none")
      .one_of({"zstd", "lz4", "none"});
  verb.callback([arguments, &status] { status = run_recover(*arguments); });
}

struct ExportArguments {
  std::string recording;
  std::filesystem::path ros2bag;
  ExportOptions options;
};

// Messages of ROS 2 in the place of tables: of a session alone, and of all its topics.
int run_ros2_bag(const ExportArguments& arguments, const Stopped& stopped) {
  const ExportOptions& options = arguments.options;
  if (!options.csv.empty() || !options.mat.empty() || !options.hdf5.empty() ||
      !options.topics.empty()) {
    throw ConfigError("--ros2bag", "it with --csv, --mat, --hdf5 or --topics", "it alone");
  }
  const report::ResultFiles checked({{"--ros2bag", arguments.ros2bag}}, {arguments.recording});
  const Ros2Bag bag = write_ros2_bag(arguments.recording, arguments.ros2bag, stopped);
  fmt::print("{:<40} {:>12}\n", "topic", "messages");
  for (const auto& [topic, messages] : bag.topics) fmt::print("{:<40} {:>12}\n", topic, messages);
  std::fflush(stdout);
  if (bag.unread > 0) {
    fmt::print(stderr, "stillhand: {} messages that do not match their type are left out\n",
               bag.unread);
  }
  return 0;
}

// The channels of lateness, one table of the whole session.
int run_lateness(const ExportArguments& arguments) {
  report::ResultFiles files({{"--lateness", arguments.options.lateness}}, {arguments.recording});
  const session::SessionRecording recorded = session::read_session(arguments.recording);
  if (!recorded.damage.empty()) {
    runtime::remark(fmt::format("{}: damaged in {} places, and what was lost counts as late: {}",
                                arguments.recording, recorded.damage.size(),
                                recorded.damage.front()));
  }
  const recording::Recording rows = session::lateness_channels(recorded);
  if (rows.row_count() == 0) {
    throw ConfigError(arguments.recording, "no step of a rig", "the recording of a session");
  }
  files.set("--lateness", recording::to_csv(rows));
  files.publish();
  fmt::print("{}: {} rows of {} channels\n", arguments.options.lateness.string(), rows.row_count(),
             rows.columns.size());
  return 0;
}

int run_export(const ExportArguments& arguments) {
  runtime::Stop stop;
  ExportOptions options = arguments.options;
  options.stopped = [&stop] { return stop.requested(); };
  if (!arguments.ros2bag.empty()) return run_ros2_bag(arguments, options.stopped);
  const bool tables = !options.csv.empty() || !options.mat.empty() || !options.hdf5.empty();
  if (!arguments.options.lateness.empty() && !tables) return run_lateness(arguments);
  if (!tables) {
    throw ConfigError("export", "no format",
                      "--csv DIR, --mat FILE, --hdf5 FILE, --ros2bag FILE or --lateness FILE");
  }
  const Exported exported = export_recording(arguments.recording, options);
  fmt::print("{:<40} {:>12} {:>9}\n", "table", "rows", "columns");
  for (const ExportedTopic& topic : exported.topics) {
    fmt::print("{:<40} {:>12} {:>9}\n", topic.name, topic.rows, topic.columns);
  }
  std::fflush(stdout);
  for (const ExportedTopic& topic : exported.topics) {
    if (topic.unread == 0) continue;
    runtime::remark(fmt::format("{}: {} messages that do not match their type are left out",
                                topic.topic, topic.unread));
  }
  for (const std::string& reason : exported.left_out) {
    runtime::remark("left out: " + reason);
  }
  return arguments.options.lateness.empty() ? 0 : run_lateness(arguments);
}

void add_export(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<ExportArguments>();
  command_line::Command verb = file_verb(
      cli, arguments->recording, "export",
      "Writes a recording as tables, one for each topic: a folder of CSV files, a MATLAB file\n"
      "(version 5), an HDF5 file, or all three. The first column is `t [s]` since the\n"
      "recording's start; units come from the IDL that the recording carries. Any recording in\n"
      "CDR with its IDL as schema can be exported.\n"
      "Example: stillhand export demo/session.mcap --csv tables --hdf5 session.h5");
  verb.add_option("--csv", arguments->options.csv, "folder for CSV files, one for each topic");
  verb.add_option("--mat", arguments->options.mat, "MATLAB file, one struct for each topic");
  verb.add_option("--hdf5", arguments->options.hdf5, "HDF5 file, one group for each topic");
  verb.add_option("--ros2bag", arguments->ros2bag,
                  "MCAP file with messages of ROS 2 (sensor_msgs/Imu and so on), of a session");
  verb.add_option("--lateness", arguments->options.lateness,
                  "CSV file with what came late in each tick of a session: age of the answers, "
                  "lost ticks, ...");
  verb.add_option("--topics", arguments->options.topics,
                  "names or patterns with * and ?, comma-separated [every topic]")
      .delimiter(',')
      .takes_all();
  verb.callback([arguments, &status] { status = run_export(*arguments); });
}

}  // namespace

void add_file_commands(command_line::Command& cli, int& status) {
  add_info(cli, status);
  add_verify(cli, status);
  add_recover(cli, status);
  add_export(cli, status);
}

}  // namespace stillhand::recordings

// SPDX-License-Identifier: Apache-2.0
#include "apps/recordings/recorder_commands.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/recordings/export.hpp"
#include "apps/recordings/info.hpp"
#include "apps/recordings/recover.hpp"
#include "apps/report/result_files.hpp"
#include "services/contract/config_error.hpp"
#include "services/recording/core/mcap/compression.hpp"
#include "services/recording/core/mcap/mcap_loss.hpp"
#include "services/runtime/process/stop.hpp"

namespace stillhand::recordings {
namespace {

struct InfoWords {
  std::string recording;
  std::filesystem::path json;
};

int run_info(const InfoWords& words) {
  report::ResultFiles files({{"--json", words.json}}, {words.recording});
  OpenRecording recording(words.recording);
  const RecordingInfo info = info_of(recording);
  if (files.wants("--json")) files.set("--json", info_json(info));
  files.publish();
  std::fputs(info_text(info).c_str(), stdout);
  recording.tell_loss(info.messages);
  return 0;
}

void add_info(CLI::App& cli, int& status) {
  auto words = std::make_shared<InfoWords>();
  CLI::App* verb = cli.add_subcommand(
      "info",
      "What is in a recording: topics, types, messages, rates, lost ticks, QoS, metadata, damage.\n"
      "Reads all of it, every checksum too. A file that a crash left open is read as far as it\n"
      "goes, and so said.\n"
      "Example: stillhand info demo/session.mcap --json info.json");
  verb->add_option("FILE", words->recording, "recording (MCAP)")->required();
  verb->add_option("--json", words->json, "file of everything that was found");
  verb->callback([words, &status] { status = run_info(*words); });
}

int run_verify(const std::string& path) {
  OpenRecording recording(path);
  std::uint64_t messages = 0;
  check(recording.reader.verify([&](const recording::MessageView&) { ++messages; }));
  const auto& damage = recording.reader.damage();
  const bool being_written = recording.source.being_written();
  if (damage.empty() && !being_written) {
    std::printf("%s: whole; %llu messages, every checksum is right\n", path.c_str(),
                static_cast<unsigned long long>(messages));
    return 0;
  }
  std::fputs(damage_text(damage).c_str(), stdout);
  recording.tell_loss(messages);
  return 1;
}

void add_verify(CLI::App& cli, int& status) {
  auto path = std::make_shared<std::string>();
  CLI::App* verb = cli.add_subcommand(
      "verify",
      "Reads a recording whole and checks every checksum. Exit status 1 when anything is damaged,\n"
      "cut off or still being written; each finding is listed with its place.\n"
      "Example: stillhand verify demo/session.mcap");
  verb->add_option("FILE", *path, "recording (MCAP)")->required();
  verb->callback([path, &status] { status = run_verify(*path); });
}

struct RecoverWords {
  std::string recording;
  RecoverOptions options;
  std::string compression = "zstd";
};

int run_recover(RecoverWords words) {
  runtime::Stop stop;
  words.options.stopped = [&stop] { return stop.requested(); };
  words.options.compression =
      *recording::compression_of(words.compression == "none" ? "" : words.compression);
  const Recovered result = recover(words.recording, words.options);
  if (result.was_whole) {
    std::printf("%s: whole; nothing to recover\n", words.recording.c_str());
    return 0;
  }
  for (const std::string& finding : result.findings) std::printf("%s\n", finding.c_str());
  std::printf("%llu messages recovered into %s; %s of the old file lost\n",
              static_cast<unsigned long long>(result.messages), result.out.c_str(),
              recording::byte_count(result.lost_bytes).c_str());
  if (result.attachments > 0) {
    std::printf("%u attachments are in the old file only\n", result.attachments);
  }
  if (!result.kept.empty()) std::printf("the old file is kept as %s\n", result.kept.c_str());
  return 0;
}

void add_recover(CLI::App& cli, int& status) {
  auto words = std::make_shared<RecoverWords>();
  CLI::App* verb = cli.add_subcommand(
      "recover",
      "Writes what can be read of a cut-off or damaged recording into a whole file, and tells "
      "what\n"
      "was lost. Without --out the whole file takes the name and the old one is kept as\n"
      "FILE.damaged; with it the old one stays as it is. The new file appears when it is complete\n"
      "and on the disk. A whole file is left alone.\n"
      "Example: stillhand recover crashed.mcap --out whole.mcap");
  verb->add_option("FILE", words->recording, "recording (MCAP)")->required();
  verb->add_option("--out", words->options.out, "name of the whole file, a free one");
  verb->add_option("--compression", words->compression, "of its chunks: zstd, lz4 or none")
      ->check(CLI::IsMember({"zstd", "lz4", "none"}))
      ->capture_default_str();
  verb->callback([words, &status] { status = run_recover(*words); });
}

struct ExportWords {
  std::string recording;
  ExportOptions options;
};

int run_export(const ExportWords& words) {
  runtime::Stop stop;
  ExportOptions options = words.options;
  options.stopped = [&stop] { return stop.requested(); };
  if (options.csv.empty() && options.mat.empty() && options.hdf5.empty()) {
    throw ConfigError("export", "no format", "--csv DIR, --mat FILE or --hdf5 FILE");
  }
  const Exported exported = export_recording(words.recording, options);
  std::printf("%-40s %12s %9s\n", "table", "rows", "columns");
  for (const ExportedTopic& topic : exported.topics) {
    std::printf("%-40s %12llu %9zu\n", topic.name.c_str(),
                static_cast<unsigned long long>(topic.rows), topic.columns);
  }
  std::fflush(stdout);
  for (const ExportedTopic& topic : exported.topics) {
    if (topic.unread == 0) continue;
    std::fprintf(stderr, "stillhand: %s: %llu messages that are not of their type left out\n",
                 topic.topic.c_str(), static_cast<unsigned long long>(topic.unread));
  }
  for (const std::string& reason : exported.left_out) {
    std::fprintf(stderr, "stillhand: left out: %s\n", reason.c_str());
  }
  return 0;
}

void add_export(CLI::App& cli, int& status) {
  auto words = std::make_shared<ExportWords>();
  CLI::App* verb = cli.add_subcommand(
      "export",
      "A recording as tables, one a topic: a folder of CSV files, a MATLAB file (version 5), an\n"
      "HDF5 file, or all three. Column `t [s]` first, from the recording's start; units from the\n"
      "IDL that the recording carries. Any recording in CDR with its IDL as schema is exported.\n"
      "Example: stillhand export demo/session.mcap --csv tables --hdf5 session.h5");
  verb->add_option("FILE", words->recording, "recording (MCAP)")->required();
  verb->add_option("--csv", words->options.csv, "folder of one CSV file a topic");
  verb->add_option("--mat", words->options.mat, "MATLAB file, one struct a topic");
  verb->add_option("--hdf5", words->options.hdf5, "HDF5 file, one group a topic");
  verb->add_option("--topics", words->options.topics,
                   "names or patterns with * and ?, comma-separated [every topic]")
      ->delimiter(',')
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  verb->callback([words, &status] { status = run_export(*words); });
}

}  // namespace

void add_file_commands(CLI::App& cli, int& status) {
  add_info(cli, status);
  add_verify(cli, status);
  add_recover(cli, status);
  add_export(cli, status);
}

}  // namespace stillhand::recordings

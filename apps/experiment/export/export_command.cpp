// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/export_command.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/experiment/export/bids.hpp"
#include "apps/experiment/export/bids_texts.hpp"
#include "apps/experiment/export/set_files.hpp"
#include "apps/experiment/export/tables.hpp"
#include "apps/libraries/experiment/file/experiment_file.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/recordings/csv_tables.hpp"
#include "apps/recordings/hdf5_tables.hpp"
#include "apps/recordings/mat_tables.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/recording/file_io.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::experiment {
namespace {

struct ExportOptions {
  std::filesystem::path folder;
  std::filesystem::path out;
  bool bids = false;
  bool csv = false;
  bool mat = false;
  bool hdf5 = false;
  Release release;
};

// A data set is the files of one export and no others.
void check_new(const std::filesystem::path& out) {
  std::error_code error;
  if (std::filesystem::exists(out, error) && !std::filesystem::is_empty(out, error)) {
    throw ConfigError("--out", out.string() + ", which holds something",
                      "a new folder, or an empty one");
  }
}

// Plain tables, and the texts next to them.
std::vector<std::string> write_plain(const ExportOptions& options, const DataSet& set,
                                     const Folder& folder, report::StagedFolder& staged,
                                     const OnSession& shown) {
  const auto place = [&](const char* name) { return (staged.path() / name).string(); };
  std::unique_ptr<recordings::TableFile> file =
      options.csv   ? recordings::csv_tables(staged.path())
      : options.mat ? recordings::mat_tables(place("experiment.mat"))
                    : recordings::hdf5_tables(place("experiment.h5"));
  const auto left_out = write_tables(set, folder, *file, shown);
  file->publish();
  file.reset();
  SetFiles files(staged);
  for (const auto& entry : std::filesystem::directory_iterator(staged.path())) {
    files.add(entry.path().filename().string());
  }
  files.write("README", tables_readme(folder, set, options.release));
  files.write("columns.json", columns_json(folder.design()));
  files.write(kDesignFile, registered_text(folder.path()));
  files.write_sums();
  return left_out;
}

void export_set(const ExportOptions& options) {
  if (int{options.bids} + int{options.csv} + int{options.mat} + int{options.hdf5} != 1) {
    throw ConfigError("export", "no form, or more than one",
                      "one of --bids, --csv, --mat and --hdf5");
  }
  const Folder folder(options.folder);
  check_new(options.out);
  runtime::Stop stop;
  report::ProgressLine progress;
  const auto shown = [&](const char* what) {
    return [&, what](std::int64_t done, std::int64_t all) {
      progress.show(what, static_cast<double>(done) / static_cast<double>(all));
      return !stop.requested();
    };
  };
  const DataSet set = data_set_of(folder, shown("reading participants"));
  report::StagedFolder staged(options.out);
  const auto writing = shown("writing participants");
  const auto left_out = options.bids ? write_bids(set, folder, options.release, staged, writing)
                                     : write_plain(options, set, folder, staged, writing);
  progress.finish();
  staged.publish({});
  for (const std::string& line : left_out) fmt::print("left out: {}\n", line);
  fmt::print("{} participants in {}\n", set.participants.size(), options.out.string());
}

}  // namespace

void add_export_command(command_line::Command& verb) {
  const auto options = std::make_shared<ExportOptions>();
  command_line::Command sub = verb.add_subcommand(
      "export",
      "Writes the data set of an unblinded experiment: codes, conditions, samples, results.");
  sub.add_option("DIR", options->folder, "folder of the experiment")
      .required()
      .check(settings::check_name);
  sub.add_option("--out", options->out, "new folder of the data set").required();
  sub.add_flag("--bids", options->bids,
               "Brain Imaging Data Structure: motion and behavioural tables with JSON side files");
  sub.add_flag("--csv", options->csv, "a CSV file for each table and trial");
  sub.add_flag("--mat", options->mat, "the same tables as one MATLAB file (version 5)");
  sub.add_flag("--hdf5", options->hdf5, "the same tables as one HDF5 file");
  sub.add_option("--license", options->release.licence,
                 "licence of the data set, for example CC0-1.0 or CC-BY-4.0")
      .check(settings::check_name);
  sub.add_option("--author", options->release.authors, "author of the data set; may be repeated")
      .repeatable();
  sub.callback([options] { export_set(*options); });
}

}  // namespace stillhand::experiment

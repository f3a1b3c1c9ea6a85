// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/export/export_command.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "apps/experiment/export/bids.hpp"
#include "apps/report/progress.hpp"
#include "services/contract/config_error.hpp"
#include "services/runtime/process/stop.hpp"
#include "services/settings/check_name.hpp"

namespace stillhand::experiment {
namespace {

struct Words {
  std::filesystem::path folder;
  std::filesystem::path out;
  bool bids = false;
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

void export_set(const Words& words) {
  if (!words.bids) throw ConfigError("export", "no form", "--bids");
  const Folder folder(words.folder);
  check_new(words.out);
  runtime::Stop stop;
  report::ProgressLine progress;
  const auto shown = [&](const char* what) {
    return [&, what](std::int64_t done, std::int64_t all) {
      progress.show(what, static_cast<double>(done) / static_cast<double>(all));
      return !stop.requested();
    };
  };
  const DataSet set = data_set_of(folder, shown("reading participants"));
  report::StagedFolder staged(words.out);
  const auto left_out =
      write_bids(set, folder, words.release, staged, shown("writing participants"));
  progress.finish();
  staged.publish({});
  for (const std::string& line : left_out) fmt::print("left out: {}\n", line);
  fmt::print("{} participants in {}\n", set.participants.size(), words.out.string());
}

}  // namespace

void add_export_command(CLI::App& verb) {
  const auto words = std::make_shared<Words>();
  CLI::App* sub = verb.add_subcommand(
      "export",
      "Writes the data set of an unblinded experiment: codes, conditions, samples, results.");
  sub->add_option("DIR", words->folder, "folder of the experiment")
      ->required()
      ->check(settings::check_name);
  sub->add_option("--out", words->out, "new folder of the data set")->required();
  sub->add_flag("--bids", words->bids,
                "Brain Imaging Data Structure: motion and behavioural tables with JSON side files");
  sub->add_option("--license", words->release.licence,
                  "licence of the data set, for example CC0-1.0 or CC-BY-4.0")
      ->check(settings::check_name)
      ->capture_default_str();
  sub->add_option("--author", words->release.authors, "author of the data set; may be repeated");
  sub->callback([words] { export_set(*words); });
}

}  // namespace stillhand::experiment

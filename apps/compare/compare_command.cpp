// SPDX-License-Identifier: Apache-2.0
#include "apps/compare/compare_command.hpp"

#include <filesystem>
#include <iostream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "apps/compare/comparison_page.hpp"
#include "apps/compare/core/comparison.hpp"
#include "apps/compare/findings.hpp"
#include "apps/compare/summary_file.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::compare {
namespace {

struct CompareOptions {
  std::vector<std::filesystem::path> folders;
  std::filesystem::path out;
};

void run_compare(const CompareOptions& options) {
  const Comparison all = compared(read_summaries(options.folders));
  if (all.options.empty()) {
    throw ConfigError(options.folders.front().string(), "no condition besides A and B",
                      "a study or session with a condition to compare");
  }
  std::cout << report::in_plain_text(options_table(all));
  for (const std::string& finding : findings(all)) std::cout << finding << '\n';
  if (options.out.empty()) return;
  report::StagedFolder folder(options.out);
  write_report(all, folder.path());
  folder.write("comparison.json", comparison_json(all));
  folder.publish({std::begin(kReportFiles), std::end(kReportFiles)});
  std::cout << "comparison in " << options.out.string() << '\n';
  report::say_open(options.out / "comparison.html");
}

}  // namespace

void add_compare_command(command_line::Command& cli, int& status) {
  auto options = std::make_shared<CompareOptions>();
  command_line::Command compare = cli.add_subcommand(
      "compare",
      "Puts studies or sessions side by side: every condition but A and B is an option; the "
      "result\n"
      "names which to use for which metric, whom it leaves worse off, and how sure that is.\n"
      "Example: stillhand compare study1 study2 --out comparison1");
  compare
      .add_option("folders", options->folders,
                  "folders with a summary.json: of study, lab, experiment report or "
                  "close-the-loop")
      .required()
      .check(settings::check_name);
  compare.add_option("--out", options->out, "folder for page, figure and numbers [none]")
      .check(settings::check_name);
  compare.callback([options, &status] {
    run_compare(*options);
    status = 0;
  });
}

}  // namespace stillhand::compare

// SPDX-License-Identifier: Apache-2.0
#include "apps/experiment/report_command.hpp"

#include <filesystem>
#include <memory>

#include "apps/experiment/folder/folder.hpp"
#include "apps/libraries/report/command_line.hpp"
#include "apps/study/plan_options.hpp"
#include "apps/study/study_runs.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/system/command_line/command_line.hpp"

namespace stillhand::experiment {
namespace {

constexpr const char* kReportFolder = "report";

struct ReportOptions {
  std::filesystem::path folder;
  study::StudyRecord record;
};

// The study of the recordings: `stillhand study --sessions DIR --out DIR/report`, after the checks
// of the folder.
int report_on(ReportOptions& options) {
  const Folder folder(options.folder);
  folder.refuse_findings();
  options.record.command_line = report::command_line();
  return study::run_recorded(options.record, {folder.path()}, folder.path() / kReportFolder);
}

}  // namespace

void add_report_command(command_line::Command& verb, int& status) {
  const auto options = std::make_shared<ReportOptions>();
  command_line::Command sub = verb.add_subcommand(
      "report",
      "Writes DIR/report: tables, figures and tests of an unblinded experiment, as\n"
      "`stillhand study --sessions DIR` computes them.");
  sub.add_option("DIR", options->folder, "folder of the experiment")
      .required()
      .check(settings::check_name);
  study::add_plan_options(sub, options->record.plan_dz);
  study::add_people_options(sub, options->record);
  sub.add_option("--threads", options->record.options.threads,
                 "number of threads, 0: one per core; the results do not depend on it")
      .between(0, 256);
  sub.callback([options, &status] { status = report_on(*options); });
}

}  // namespace stillhand::experiment

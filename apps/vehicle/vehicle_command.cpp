// SPDX-License-Identifier: Apache-2.0
#include "apps/vehicle/vehicle_command.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

#include "apps/libraries/report/command_line.hpp"
#include "apps/libraries/report/plot/draw.hpp"
#include "apps/libraries/report/progress.hpp"
#include "apps/libraries/report/staged_folder.hpp"
#include "apps/vehicle/region.hpp"
#include "apps/vehicle/region_output.hpp"
#include "services/files/settings/check_name.hpp"
#include "services/files/settings/check_number.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/remark.hpp"
#include "services/system/process/stop.hpp"

namespace stillhand::vehicle {
namespace {

struct Arguments {
  RegionOptions options;
  std::filesystem::path out;
};

int run(const Arguments& arguments) {
  runtime::Stop stop;
  RegionOptions options = arguments.options;
  if (options.gains_m_s2_rad.empty()) options.gains_m_s2_rad = geometric_gains();
  preset(options.preset);  // an unknown name is refused before the folder is made
  report::StagedFolder folder(arguments.out);
  report::require_gnuplot();
  report::ProgressLine progress;
  const Region region = map_region(options, [&](const char* step, double done) {
    progress.show(step, done);
    return !stop.requested();
  });
  progress.finish();
  if (region.runs.empty()) {
    runtime::remark("stopped; nothing was written");
    return 1;
  }
  folder.write("summary.json", region_json(options, region));
  folder.write("runs.csv", runs_csv(region));
  folder.write("limits.csv", limits_csv(region));
  const auto drawings = report::render({{region_figure(options, region)}}, folder.path());
  region_page(options, region, report::command_line(), drawings)
      .write(folder.path() / "report.html");
  folder.publish(region_files());
  std::fputs(region_text(options, region).c_str(), stdout);
  report::say_report(arguments.out);
  return 0;
}

}  // namespace

void add_vehicle_command(command_line::Command& cli, int& status) {
  auto arguments = std::make_shared<Arguments>();
  RegionOptions& options = arguments->options;
  command_line::Command verb = cli.add_subcommand(
      "vehicle",
      "Maps the stable region of the loop through vehicle and hand, in one process: the stick\n"
      "drives the vehicle whose acceleration shakes the hand. Each simulated subject is\n"
      "identified; the critical gain is predicted, and the whole grid of gain and delay is\n"
      "driven, without and with cancellation. A growing oscillation ends a drive.\n"
      "Example: stillhand vehicle --preset excavator --subjects 6 --out region");
  verb.add_option("--out", arguments->out, "folder for figure, report and numbers")
      .required()
      .check(settings::check_name);
  verb.add_option("--preset", options.preset, "vehicle")
      .type_name("{first_order,second_order,excavator,wheelchair,aircraft_roll}");
  verb.add_option("--subjects", options.subjects, "number of simulated subjects").between(1, 1000);
  verb.add_option("--seed", options.seed, "of everything random").between(0, 2'000'000'000);
  verb.add_option("--gains", options.gains_m_s2_rad,
                  "gains of the grid [m/s^2 per rad], rising, 0.1 to 100; 17 from 4 to 100 if "
                  "none is given")
      .delimiter(',');
  verb.add_option("--delays", options.delays_s, "delays of the grid [s], rising, 0.02 to 1")
      .delimiter(',');
  verb.add_option("--drive-seconds", options.drive_s, "length of each drive [s]")
      .check(settings::number_between(6.0, 600.0));
  verb.add_option("--threads", options.threads,
                  "number of threads, 0: one per core; the results do not depend on it")
      .between(0, 256);
  verb.callback([arguments, &status] { status = run(*arguments); });
}

}  // namespace stillhand::vehicle

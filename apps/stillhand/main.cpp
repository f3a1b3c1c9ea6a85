// SPDX-License-Identifier: Apache-2.0
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "apps/calibrate/calibrate_command.hpp"
#include "apps/close_the_loop/closed_loop_command.hpp"
#include "apps/close_the_loop/control_model_command.hpp"
#include "apps/compare/compare_command.hpp"
#include "apps/dashboard/dashboard_command.hpp"
#include "apps/deploy/deploy_command.hpp"
#include "apps/diagnose/diagnose_command.hpp"
#include "apps/experiment/experiment_command.hpp"
#include "apps/identify/identify_command.hpp"
#include "apps/lab/conductor.hpp"
#include "apps/lab/lab_command.hpp"
#include "apps/misses/misses_command.hpp"
#include "apps/plan_run/plan_run_command.hpp"
#include "apps/predict/predict_command.hpp"
#include "apps/record/record_command.hpp"
#include "apps/recordings/recorder_commands.hpp"
#include "apps/replay/replay_command.hpp"
#include "apps/ros2_bridge/ros2_bridge_command.hpp"
#include "apps/stillhand/help.hpp"
#include "apps/stop/stop_command.hpp"
#include "apps/study/study_command.hpp"
#include "apps/vehicle/vehicle_command.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/system/command_line/command_line.hpp"
#include "services/system/process/remark.hpp"
#include "version.hpp"

namespace {

namespace runtime = stillhand::runtime;

// A verb whose output could not be written has failed.
int flushed(int status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout.good() && std::ferror(stdout) == 0) return status;
  runtime::remark("standard output cannot be written; redirect it to a file or terminal with room");
  return status == 0 ? 1 : status;
}

// The library's own text says which of its functions failed.
int refused(const std::filesystem::filesystem_error& error) {
  const std::error_code& why = error.code();
  const bool of_machine = why == std::errc::io_error || why == std::errc::no_space_on_device ||
                          why == std::errc::too_many_files_open;
  runtime::remark(stillhand::ConfigError(error.path1().string(), why.message(),
                                         "a file or folder that this user can reach")
                      .what());
  return of_machine ? 1 : 2;
}

int run(int argc, char** argv) {
  std::signal(SIGXFSZ,
              SIG_IGN);  // a write beyond the limit of a file's size then fails like others
  stillhand::command_line::Program cli(
      "Stillhand measures, models and cancels biodynamic feedthrough.");
  cli.name("stillhand");
  cli.version(stillhand::kVersion);
  cli.require_subcommand();
  // A script gives its defaults first and the user's words after them.
  cli.last_word_counts();
  int status = 0;
  try {
    stillhand::lab::add_lab_command(cli, status);
    stillhand::experiment::add_experiment_command(cli, status);
    stillhand::study::add_study_command(cli, status);
    stillhand::compare::add_compare_command(cli, status);
    stillhand::vehicle::add_vehicle_command(cli, status);
    stillhand::identify::add_identify_command(cli, status);
    stillhand::diagnose::add_diagnose_command(cli, status);
    stillhand::plan_run::add_plan_run_command(cli, status);
    stillhand::close_the_loop::add_closed_loop_command(cli, status);
    stillhand::close_the_loop::add_control_model_command(cli, status);
    stillhand::predict::add_predict_command(cli, status);
    stillhand::recordings::add_file_commands(cli, status);
    stillhand::misses::add_misses_command(cli, status);
    stillhand::record::add_record_command(cli, status);
    stillhand::replay::add_replay_command(cli, status);
    stillhand::ros2_bridge::add_ros2_bridge_command(cli, status);
    stillhand::dashboard::add_dashboard_command(cli, status);
    stillhand::calibrate::add_calibrate_command(cli, status);
    stillhand::stop::add_stop_command(cli, status);
    stillhand::deploy::add_deploy_command(cli, status);
    stillhand::add_help(cli);
    std::vector<std::string> words = stillhand::without_help_verb({argv + 1, argv + argc});
    if (words.empty()) {
      std::cerr << cli.help();
      return 2;
    }
    if (const std::string why = stillhand::misspelt_verb(words); !why.empty()) {
      std::cerr << "stillhand: " << why << '\n';
      return 2;
    }
    cli.parse(std::move(words));
    return flushed(status);
  } catch (const stillhand::command_line::UsageError& error) {
    if (error.status() == 0) return flushed(error.print());  // --help, --version
    std::cerr << stillhand::usage_error(cli, error.what()) << '\n';
    return 2;
  } catch (const stillhand::ConfigError& error) {
    runtime::remark(error.what());
    return 2;
  } catch (const stillhand::lab::RefusedByProcess& error) {
    std::cerr << error.what() << '\n';
    return 2;
  } catch (const std::filesystem::filesystem_error& error) {
    return refused(error);
  } catch (const std::exception& error) {
    runtime::remark(error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (...) {
    return 1;  // there is no text to print
  }
}

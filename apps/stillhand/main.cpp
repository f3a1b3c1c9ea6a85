// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>

#include "closed_loop/closed_loop_command.hpp"
#include "closed_loop/control_model_command.hpp"
#include "contract/config_error.hpp"
#include "dashboard/dashboard_command.hpp"
#include "deploy/deploy_command.hpp"
#include "diagnose/diagnose_command.hpp"
#include "experiment/conductor.hpp"
#include "experiment/lab_command.hpp"
#include "identify/identify_command.hpp"
#include "predict/predict_command.hpp"
#include "record/record_command.hpp"
#include "recorder/recorder_commands.hpp"
#include "replayer/replay_command.hpp"
#include "study/study_command.hpp"

namespace {

// What could not be printed was not told.
int told(int status) {
  std::cout.flush();
  if (std::fflush(stdout) == 0 && std::cout.good() && std::ferror(stdout) == 0) return status;
  std::cerr << "stillhand: standard output: it cannot be written, want one that can\n";
  return status == 0 ? 1 : status;
}

int run(int argc, char** argv) {
  CLI::App cli("Stillhand measures, models and cancels biodynamic feedthrough.");
  cli.name("stillhand");
  cli.set_version_flag("--version", STILLHAND_VERSION);
  cli.require_subcommand(1);
  // A script's defaults come first, a user's words after them.
  cli.option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  int status = 0;
  try {
    stillhand::experiment::add_lab_command(cli, status);
    stillhand::study::add_study_command(cli, status);
    stillhand::identify::add_identify_command(cli, status);
    stillhand::diagnose::add_diagnose_command(cli, status);
    stillhand::closed_loop::add_closed_loop_command(cli, status);
    stillhand::closed_loop::add_control_model_command(cli, status);
    stillhand::predict::add_predict_command(cli, status);
    stillhand::recorder::add_file_commands(cli, status);
    stillhand::record::add_record_command(cli, status);
    stillhand::replayer::add_replay_command(cli, status);
    stillhand::dashboard::add_dashboard_command(cli, status);
    stillhand::deploy::add_deploy_command(cli, status);
    cli.parse(argc, argv);
    return told(status);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return told(cli.exit(error));  // --help, --version
    std::cerr << "stillhand: " << error.what() << "; `stillhand <verb> --help` tells\n";
    return 2;
  } catch (const stillhand::ConfigError& error) {
    std::cerr << "stillhand: " << error.what() << '\n';
    return 2;
  } catch (const stillhand::experiment::RefusedByProcess& error) {
    std::cerr << error.what() << '\n';
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "stillhand: " << error.what() << '\n';
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (...) {
    return 1;  // nothing is left that could be told
  }
}

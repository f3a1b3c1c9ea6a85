// SPDX-License-Identifier: Apache-2.0
#include "services/processes/recording/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  recording::KeepOptions keep;
  recording::OfExperiment place;
  return runtime::run_service(
      "recorder", argc, argv,
      [&](runtime::Service& service) {
        recording::Shell shell(service, keep, place);
        shell.run();
      },
      [&](command_line::Command& cli, runtime::ServiceOptions& options) {
        options.serialized = true;
        recording::add_keep_options(cli, keep);
        recording::add_experiment_options(cli, place);
      });
}

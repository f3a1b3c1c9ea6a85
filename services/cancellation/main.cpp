// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "services/cancellation/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  return runtime::run_service(
      "cancellation", argc, argv,
      [](runtime::Service& service) {
        cancellation::Shell shell(service);
        shell.run();
      },
      [](CLI::App& cli, runtime::ServiceOptions& options) {
        cli.add_flag("--answer-replay", options.answers_replay,
                     "answer a replayed recording; no rig takes the answers");
      });
}

// SPDX-License-Identifier: Apache-2.0
#include "services/processes/human_operator/shell.hpp"
#include "services/system/command_line/command_line.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  bool with_pointer = false;
  return runtime::run_service(
      "human_operator", argc, argv,
      [&](runtime::Service& service) {
        human_operator::Shell shell(service, with_pointer);
        shell.run();
      },
      [&](command_line::Command& cli, runtime::ServiceOptions&) {
        cli.add_flag("--pointer", with_pointer,
                     "use a person's mouse instead of the simulated subject");
      });
}

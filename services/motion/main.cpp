// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "motion/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  std::filesystem::path ride;
  return runtime::run_service(
      "motion", argc, argv,
      [&](runtime::Service& service) {
        motion::Shell shell(service, ride);
        shell.run();
      },
      [&](CLI::App& cli, runtime::ServiceOptions&) {
        cli.add_option("--ride", ride, "recorded ride to follow: CSV with a_y [m/s^2], or .mcap");
      });
}

// SPDX-License-Identifier: Apache-2.0
#include "recording/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  return runtime::run_service(
      "recorder", argc, argv,
      [](runtime::Service& service) {
        recording::Shell shell(service);
        shell.run();
      },
      [](CLI::App&, runtime::ServiceOptions& options) { options.serialized = true; });
}

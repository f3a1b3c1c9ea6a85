// SPDX-License-Identifier: Apache-2.0
#include "services/processes/identification/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  return runtime::run_service("identification", argc, argv, [](runtime::Service& service) {
    identification::Shell shell(service);
    shell.run();
  });
}

// SPDX-License-Identifier: Apache-2.0
#include "cancellation/shell.hpp"

int main(int argc, char** argv) {
  using namespace stillhand;
  return runtime::run_service("cancellation", argc, argv, [](runtime::Service& service) {
    cancellation::Shell shell(service);
    shell.run();
  });
}

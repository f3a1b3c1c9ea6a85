// SPDX-License-Identifier: Apache-2.0
#include "rig/shell.hpp"

int main(int argc, char** argv) {
  return stillhand::runtime::run_service("rig", argc, argv,
                                         [](stillhand::runtime::Service& service) {
                                           stillhand::rig::Shell shell(service);
                                           shell.run();
                                         });
}

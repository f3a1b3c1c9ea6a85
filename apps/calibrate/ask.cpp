// SPDX-License-Identifier: Apache-2.0
#include "apps/calibrate/ask.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <iostream>

#include "services/core/contract/config_error.hpp"

namespace stillhand::calibrate {

void want_terminal() {
  if (isatty(STDIN_FILENO) == 1) return;
  throw ConfigError("standard input", "no terminal",
                    "a terminal: a person at the rig confirms each step");
}

bool done_by_person(const std::string& step, const runtime::Stop& interrupted) {
  tcflush(STDIN_FILENO, TCIFLUSH);
  std::cout << step << " Then press Enter.\n" << std::flush;
  constexpr int kLook_ms = 50;
  while (!interrupted.requested()) {
    pollfd input{STDIN_FILENO, POLLIN, 0};
    if (poll(&input, 1, kLook_ms) <= 0) continue;
    char letter = 0;
    if (::read(STDIN_FILENO, &letter, 1) <= 0) return false;
    if (letter == '\n') return true;
  }
  return false;
}

}  // namespace stillhand::calibrate

// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/typed_line.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <array>

namespace stillhand::lab {

// The terminal stops a program in its background that reads it, or takes away what was typed.
bool TypedLine::possible() {
  const pid_t in_front = tcgetpgrp(STDIN_FILENO);  // -1: not the terminal that this session obeys
  return isatty(STDIN_FILENO) != 0 && (in_front < 0 || in_front == getpgrp());
}

TypedLine::TypedLine() { tcflush(STDIN_FILENO, TCIFLUSH); }

// A terminal hands over whole lines.  One that is gone has no more of them.
bool TypedLine::is_there() {
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (poll(&input, 1, 0) <= 0) return false;
  std::array<char, 256> typed{};
  const ssize_t size = read(STDIN_FILENO, typed.data(), typed.size());
  if (size > 0) text_.assign(typed.data(), static_cast<std::size_t>(size));
  if (text_.ends_with('\n')) text_.pop_back();
  return true;
}

}  // namespace stillhand::lab

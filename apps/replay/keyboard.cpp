// SPDX-License-Identifier: Apache-2.0
#include "apps/replay/keyboard.hpp"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <string_view>
#include <utility>

namespace stillhand::replay {
namespace {

constexpr long kNsPerSecond = 1'000'000'000;

std::optional<Key> key_of(std::string_view bytes) {
  if (bytes.empty()) return std::nullopt;
  if (bytes == "\033[D" || bytes == "\033OD") return Key::kBack;
  if (bytes == "\033[C" || bytes == "\033OC") return Key::kForward;
  constexpr std::array<std::pair<char, Key>, 8> kKeys{{{' ', Key::kPause},
                                                       {'s', Key::kStep},
                                                       {'q', Key::kQuit},
                                                       {'+', Key::kFaster},
                                                       {'-', Key::kSlower},
                                                       {'a', Key::kLoopFrom},
                                                       {'b', Key::kLoopTo},
                                                       {'c', Key::kLoopOff}}};
  const auto key = std::ranges::find(kKeys, bytes.front(), &std::pair<char, Key>::first);
  return key == kKeys.end() ? std::nullopt : std::optional(key->second);
}

}  // namespace

struct Keyboard::Saved {
  termios settings{};
};

Keyboard::Keyboard(bool wanted) {
  if (!wanted || isatty(STDIN_FILENO) != 1) return;
  auto saved = std::make_unique<Saved>();
  if (tcgetattr(STDIN_FILENO, &saved->settings) != 0) return;
  termios single = saved->settings;
  single.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  single.c_cc[VMIN] = 0;
  single.c_cc[VTIME] = 0;
  if (tcsetattr(STDIN_FILENO, TCSANOW, &single) == 0) saved_ = std::move(saved);
}

Keyboard::~Keyboard() {
  if (saved_) tcsetattr(STDIN_FILENO, TCSANOW, &saved_->settings);
}

std::optional<Key> Keyboard::wait(long limit_ns) {
  const timespec limit{limit_ns / kNsPerSecond, limit_ns % kNsPerSecond};
  pollfd input{STDIN_FILENO, POLLIN, 0};
  if (::ppoll(&input, saved_ ? 1 : 0, &limit, nullptr) <= 0) return std::nullopt;
  // A key is one byte, or the three that a terminal sends for an arrow.
  char bytes[3] = {};
  ssize_t count = ::read(STDIN_FILENO, bytes, 1);
  if (count == 1 && bytes[0] == '\033') {
    const ssize_t rest = ::read(STDIN_FILENO, bytes + 1, 2);
    count += rest > 0 ? rest : 0;
  }
  return key_of({bytes, static_cast<std::size_t>(count > 0 ? count : 0)});
}

}  // namespace stillhand::replay

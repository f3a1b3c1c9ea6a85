// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>

namespace stillhand::replay {

enum class Key {
  kPause,
  kBack,
  kForward,
  kStep,
  kQuit,
  kFaster,
  kSlower,
  kLoopFrom,
  kLoopTo,
  kLoopOff
};

/// Single keys from the terminal on standard input, without echo and without waiting for a line.
/// The terminal gets its settings back at destruction.  Nothing ever comes when standard input is
/// no terminal.  One thread.
class Keyboard {
 public:
  explicit Keyboard(bool wanted);
  ~Keyboard();
  Keyboard(const Keyboard&) = delete;
  Keyboard& operator=(const Keyboard&) = delete;

  /// The next key, waiting at most `limit_ns` for it.
  std::optional<Key> wait(long limit_ns);
  [[nodiscard]] bool active() const noexcept { return saved_ != nullptr; }

 private:
  struct Saved;
  std::unique_ptr<Saved> saved_;
};

}  // namespace stillhand::replay

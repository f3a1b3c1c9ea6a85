// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "apps/replay/message_source.hpp"
#include "services/core/recording/messages/release_errors.hpp"
#include "services/core/recording/play_clock.hpp"

namespace stillhand::replay {

/// Releases messages when they are due.  Knows neither bus nor keyboard: `release` writes one
/// message, and step() returns how long nothing will be due, so that the caller can wait for keys
/// and commands meanwhile.  One thread.
class Player {
 public:
  using Release = std::function<void(const recording::HeldMessage&, std::span<const std::byte>)>;

  /// Log times [ns]: first and last instant to play.
  Player(MessageSource& source, std::uint64_t first_ns, std::uint64_t last_ns,
         recording::PlayRate rate, bool loop, Release release);

  /// Begins at the first instant; the state before it has been read when this returns.
  void begin(bool paused);
  /// Releases the messages due within the next two milliseconds, each at its time.
  /// @returns [ns] until something may be due again; nothing when the replay is over
  std::optional<std::int64_t> step();

  void set_paused(bool paused);
  void set_rate(recording::PlayRate rate);
  /// To a log time [ns], kept within first and last.
  void seek(std::int64_t to_ns);
  /// While paused: releases the next message at once.
  void step_once();
  /// Loops from the first to the second instant; without the second nothing changes yet.
  void loop_from_here();
  void loop_to_here();
  /// The same at once, log times [ns].
  void loop_between(std::int64_t from_ns, std::int64_t to_ns);
  void loop_off();

  [[nodiscard]] bool looping() const noexcept { return loop_ || loop_to_ns_.has_value(); }
  [[nodiscard]] bool paused() const noexcept { return clock_.paused(); }
  [[nodiscard]] recording::PlayRate rate() const noexcept { return clock_.rate(); }
  /// Log time [ns] played now, not behind the end of the stretch that plays.
  [[nodiscard]] std::int64_t position_ns() const noexcept;
  [[nodiscard]] std::uint64_t released() const noexcept { return released_; }
  /// How often the machine held the replay up for more than 10 ms.
  [[nodiscard]] std::uint64_t held_up() const noexcept { return held_up_; }
  [[nodiscard]] const recording::ReleaseErrors& errors() const noexcept { return errors_; }

 private:
  void jump(std::uint64_t to_ns);
  bool fetch();
  void release_next();
  [[nodiscard]] const recording::HeldMessage& front() const {
    return stretch_.batch.messages[next_];
  }

  MessageSource& source_;
  std::uint64_t first_ns_;
  std::uint64_t last_ns_;
  bool loop_;
  Release release_;
  recording::PlayClock clock_;
  Stretch stretch_;
  std::size_t next_ = 0;
  std::uint64_t loop_from_ns_;
  std::optional<std::uint64_t> loop_to_ns_;
  std::uint64_t end_ns_;  ///< of the stretch that plays: of the loop, or of the recording
  std::uint64_t released_ = 0;
  struct Released {
    std::int64_t released_ns, due_ns;
  };
  std::optional<Released> newest_;  // of this course of the clock
  std::uint64_t held_up_ = 0;
  bool late_ = false;
  recording::ReleaseErrors errors_;
};

}  // namespace stillhand::replay

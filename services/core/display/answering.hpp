// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "services/core/display/prompt.hpp"

namespace stillhand::display {

/// From a participant's keys and clicks to the answer of a prompt.
///
///   a number, or a click on its box    chooses; another one changes the choice
///   left, right (of a gamepad)         chooses the neighbour; from nothing, the first or the last
///   Enter, Space, a click on the button confirms, once something is chosen
///
/// A prompt with one step ("go on") has nothing to choose: one act.  Otherwise two acts make an
/// answer, so that the click that ended a trial, or a slip, is none.  Pure.
class Answering {
 public:
  struct Answer {
    std::uint64_t prompt = 0;
    std::int64_t value = 0;
  };

  /// A prompt with another number forgets choice and answer.
  void show(const Prompt& prompt);
  /// @param value  1 to the steps of the prompt; anything else has no effect
  void choose(std::int64_t value);
  /// The neighbour of what is chosen: +1 right, -1 left.  It stays within the scale; from nothing,
  /// right is the first box and left the last one.
  void move(std::int64_t boxes);
  void confirm();

  /// 0: nothing.
  [[nodiscard]] std::int64_t chosen() const noexcept { return chosen_; }
  /// The confirmed answer to the prompt that is shown.
  [[nodiscard]] const std::optional<Answer>& answer() const noexcept { return answer_; }

 private:
  std::uint64_t number_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t chosen_ = 0;
  std::optional<Answer> answer_;
};

}  // namespace stillhand::display

// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/asking.hpp"

#include <fmt/format.h>

#include <limits>

namespace stillhand::lab {

void Asking::take_answers(Seen& seen, Actions& actions) {
  for (const AnswerSeen& answer : seen.answers) {
    if (answer.prompt < number_ || answer_) continue;
    if (answer.prompt == number_ && answer.value >= 1 && answer.value <= steps_) {
      answer_ = answer.value;
    } else if (!refused_) {
      actions.note = fmt::format("answer {} to prompt {} is not taken: want 1 to {} to prompt {}",
                                 answer.value, answer.prompt, steps_, number_);
      refused_ = true;
    }
  }
  seen.answers.clear();
}

Actions Asking::step(Seen& seen, std::int64_t now_ns) {
  if (begin_ns_ < 0) {
    begin_ns_ = now_ns;
    starts_ = seen.requests.starts();
  }
  Actions actions;
  take_answers(seen, actions);
  const std::int64_t limit_ns = limit_s_ ? begin_ns_ + static_cast<std::int64_t>(1e9 * *limit_s_)
                                         : std::numeric_limits<std::int64_t>::max();
  const bool over = answer_ || seen.requests.starts() != starts_ || now_ns >= limit_ns;
  if (trouble_.wait(over, seen, std::numeric_limits<std::int64_t>::max(), now_ns) !=
      Wait::kGoesOn) {
    finish();
    return actions;
  }
  actions.progress = {what_ + ": waits for the participant; Start on the dashboard goes on", 0.0};
  return actions;
}

}  // namespace stillhand::lab

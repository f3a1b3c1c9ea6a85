// SPDX-License-Identifier: Apache-2.0
#include "services/core/display/answering.hpp"

namespace stillhand::display {

void Answering::show(const Prompt& prompt) {
  if (prompt.number == number_) return;
  number_ = prompt.number;
  steps_ = prompt.steps;
  chosen_ = steps_ == 1 ? 1 : 0;
  answer_.reset();
}

void Answering::choose(std::int64_t value) {
  if (!answer_ && value >= 1 && value <= steps_) chosen_ = value;
}

void Answering::move(std::int64_t boxes) {
  choose(chosen_ == 0 && boxes < 0 ? steps_ : chosen_ + boxes);
}

void Answering::confirm() {
  if (!answer_ && chosen_ > 0) answer_ = {number_, chosen_};
}

}  // namespace stillhand::display

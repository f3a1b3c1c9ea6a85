// SPDX-License-Identifier: Apache-2.0
#include "services/core/cancellation/model_schedule.hpp"

#include <algorithm>

namespace stillhand::cancellation {

void ModelSchedule::offer(std::int32_t number, Tick from_tick) noexcept {
  waiting_ = Waiting{number, from_tick, first_tick_.has_value() && last_tick_ >= from_tick};
}

ModelSchedule::Due ModelSchedule::step(Tick tick) noexcept {
  const bool clock_began_again = first_tick_.has_value() && tick < last_tick_;
  if (!first_tick_ || clock_began_again) first_tick_ = tick;
  last_tick_ = tick;
  if (!waiting_ || tick < waiting_->from_tick) return {};
  const Tick could_be_used = std::max(waiting_->from_tick, *first_tick_);
  const Due due{true, waiting_->late ? tick - could_be_used : 0};
  in_use_ = waiting_->number;
  waiting_.reset();
  return due;
}

}  // namespace stillhand::cancellation

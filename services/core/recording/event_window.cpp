// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/event_window.hpp"

#include <utility>

namespace stillhand::recording {

void EventWindow::add(MessageBatch batch) {
  if (batch.messages.empty()) return;
  const std::int64_t newest_ns = batch.messages.back().received_ns;
  bytes_ += batch.bytes.size();
  messages_ += batch.messages.size();
  batches_.push_back(std::move(batch));
  while (batches_.size() > 1 &&
         batches_.front().messages.back().received_ns + keep_ns_ < newest_ns) {
    drop_oldest();
  }
  while (batches_.size() > 1 && bytes_ > max_bytes_) {
    crowded_out_ += batches_.front().messages.size();
    drop_oldest();
  }
}

void EventWindow::drop_oldest() {
  bytes_ -= batches_.front().bytes.size();
  messages_ -= batches_.front().messages.size();
  batches_.pop_front();
}

std::deque<MessageBatch> EventWindow::take() {
  bytes_ = 0;
  messages_ = 0;
  return std::exchange(batches_, {});
}

}  // namespace stillhand::recording

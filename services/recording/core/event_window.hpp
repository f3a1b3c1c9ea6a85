// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "services/recording/core/held_message.hpp"

namespace stillhand::recording {

/// The last seconds of a recording, kept until something makes them worth writing.  Holds whole
/// batches: a batch leaves when its newest message is older than the window, so up to one batch
/// more than asked for is kept.  Pure; one thread.  Throws std::bad_alloc.
class EventWindow {
 public:
  /// @param keep_ns  [ns] length, positive  @param max_bytes  [B] most it may hold
  EventWindow(std::int64_t keep_ns, std::size_t max_bytes)
      : keep_ns_(keep_ns), max_bytes_(max_bytes) {}

  /// Takes a batch in the order of time and forgets what became too old.
  void add(MessageBatch batch);
  /// Everything held, oldest first; the window is empty afterwards.
  std::deque<MessageBatch> take();

  [[nodiscard]] std::uint64_t held_messages() const noexcept { return messages_; }
  /// Messages that were younger than the window and had to leave for want of room.
  [[nodiscard]] std::uint64_t crowded_out() const noexcept { return crowded_out_; }

 private:
  void drop_oldest();

  std::int64_t keep_ns_;
  std::size_t max_bytes_;
  std::deque<MessageBatch> batches_;
  std::size_t bytes_ = 0;
  std::uint64_t messages_ = 0;
  std::uint64_t crowded_out_ = 0;
};

}  // namespace stillhand::recording

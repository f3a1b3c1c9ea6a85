// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <deque>

#include "services/core/recording/held_message.hpp"

namespace stillhand::recording {

/// The last seconds of a recording, kept in memory until a trigger writes them.  It holds whole
/// batches and removes a batch when its newest message is older than the window.  It therefore
/// keeps up to one batch more than the window.  Pure; one thread.  Throws std::bad_alloc.
class EventWindow {
 public:
  /// @param keep_ns  [ns] length, positive  @param max_bytes  [B] largest content
  EventWindow(std::int64_t keep_ns, std::size_t max_bytes)
      : keep_ns_(keep_ns), max_bytes_(max_bytes) {}

  /// Adds a batch, in the order of time, and removes batches that are too old.
  void add(MessageBatch batch);
  /// The whole content, oldest first; the window is empty afterwards.
  std::deque<MessageBatch> take();

  [[nodiscard]] std::uint64_t held_messages() const noexcept { return messages_; }
  /// Messages younger than the window that were removed because of max_bytes.
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

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace stillhand::recording {

/// Place of one message in a batch, and its properties.
struct HeldMessage {
  std::uint32_t channel;
  std::uint32_t sequence;
  std::uint64_t log_time_ns;
  std::uint64_t publish_time_ns;
  std::int64_t received_ns;  ///< CLOCK_MONOTONIC: ages do not follow a clock that is set
  std::size_t begin;         ///< in the batch's bytes
  std::size_t size;
};

/// Messages before they are written, with all bytes in one buffer: clearing and refilling does not
/// allocate.
struct MessageBatch {
  std::vector<HeldMessage> messages;
  std::vector<std::byte> bytes;

  void add(HeldMessage message, std::span<const std::byte> content) {
    message.begin = bytes.size();
    message.size = content.size();
    bytes.insert(bytes.end(), content.begin(), content.end());
    messages.push_back(message);
  }
  [[nodiscard]] std::span<const std::byte> content(const HeldMessage& message) const {
    return std::span(bytes).subspan(message.begin, message.size);
  }
  void clear() {
    messages.clear();
    bytes.clear();
  }
};

}  // namespace stillhand::recording

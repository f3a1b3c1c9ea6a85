// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "tests/support/memory_bytes.hpp"

namespace stillhand::tests {

using Bytes = std::vector<std::byte>;

/// A message as a test writes it and expects it back.
struct PlainMessage {
  std::string topic;
  std::uint32_t sequence = 0;
  std::uint64_t log_time_ns = 0;
  std::uint64_t publish_time_ns = 0;
  Bytes bytes;
  bool operator==(const PlainMessage&) const = default;
};

/// Message number `n` of a test file: two topics in turn, 1 ms apart, length 8 to 39 bytes.
inline PlainMessage plain_message(std::uint32_t n) {
  PlainMessage message{n % 2 == 0 ? "even" : "odd", n, 1'000'000ull * (n + 1), 500'000, {}};
  for (std::uint32_t i = 0; i < 8 + (n * 7) % 32; ++i) {
    message.bytes.push_back(static_cast<std::byte>(n * 31 + i));
  }
  return message;
}

/// A recording of `count` messages, two topics with one schema and two metadata records.
inline Bytes recorded_file(std::uint32_t count, recording::Compression compression,
                           std::size_t chunk_bytes, bool closed = true) {
  recording::MemorySink sink;
  recording::McapWriter writer(sink, {chunk_bytes, compression, "stillhand-test"});
  bool ok = writer.add_metadata("session", {{"seed", "42"}, {"subject", "S03"}}).ok();
  const auto schema = writer.add_schema("P", "omgidl", "struct P { octet x; };");
  const auto even = writer.add_channel("even", schema, "cdr", {{"qos", "stream_1khz"}});
  const auto odd = writer.add_channel("odd", schema, "cdr");
  for (std::uint32_t n = 0; n < count; ++n) {
    const PlainMessage message = plain_message(n);
    ok = ok && writer
                   .write(n % 2 == 0 ? even : odd, message.sequence, message.log_time_ns,
                          message.publish_time_ns, message.bytes)
                   .ok();
  }
  ok = ok && writer.add_metadata("result", {{"trial", "done"}}).ok();
  if (closed) ok = ok && writer.close().ok();
  return ok ? sink.bytes() : Bytes{};
}

/// Everything a reader gives.
inline std::vector<PlainMessage> messages_of(recording::McapReader& reader,
                                             const recording::MessageFilter& filter = {}) {
  std::vector<PlainMessage> messages;
  (void)reader.for_each_message(filter, [&](const recording::MessageView& message) {
    messages.push_back({message.channel.topic, message.sequence, message.log_time_ns,
                        message.publish_time_ns,
                        Bytes(message.bytes.begin(), message.bytes.end())});
    return true;
  });
  return messages;
}

}  // namespace stillhand::tests

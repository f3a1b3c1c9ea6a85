// SPDX-License-Identifier: Apache-2.0
// Recordings as MCAP: opened by index or by scan, every message, then every checksum.  The limit on
// a chunk is low, so that the fuzzer's own limit on memory finds what ignores it.
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "tests/support/memory_bytes.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand::recording;
  MemorySource source(std::as_bytes(std::span(bytes, size)));
  McapReader reader(source, {.max_chunk_bytes = std::uint64_t{16} << 20});
  std::size_t seen = 0;
  if (!reader.status().ok()) return 0;
  static_cast<void>(reader.for_each_message({}, [&](const MessageView& message) {
    seen += message.bytes.size() + message.channel.topic.size();
    return seen < (std::size_t{1} << 24);
  }));
  static_cast<void>(reader.verify());
  return 0;
}

// SPDX-License-Identifier: Apache-2.0
// Usage: write_sample_recording FILE none|lz4|zstd
// Writes the recording that read_recording.mjs is tried on: 20,000 messages on three topics.
#include <array>
#include <cstring>
#include <iostream>

#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"

int main(int argc, char** argv) {
  using namespace stillhand::recording;
  if (argc != 3) return 2;
  const auto compression = compression_of(std::strcmp(argv[2], "none") == 0 ? "" : argv[2]);
  if (!compression) return 2;
  FileSink sink(argv[1], Existing::kReplace);
  McapWriter writer(sink, {64 * 1024, *compression});
  Status status = writer.add_metadata("session", {{"seed", "1"}, {"clock", "monotonic"}});
  const auto schema = writer.add_schema("stillhand_msgs::Sample", kSchemaEncoding,
                                        "module stillhand_msgs { struct Sample { double x; }; };");
  const ChannelId channels[] = {
      writer.add_channel("stillhand/sensed", schema, kMessageEncoding, {{"rig", "0"}}),
      writer.add_channel("stillhand/command", schema, kMessageEncoding),
      writer.add_channel("stillhand/silent", schema, kMessageEncoding)};
  for (std::uint32_t n = 0; n < 20'000 && status.ok(); ++n) {
    std::array<std::byte, 12> cdr{std::byte{0}, std::byte{1}};
    const double x = 0.001 * n;
    std::memcpy(cdr.data() + 4, &x, sizeof(x));
    status = writer.write(channels[n % 2], n / 2, 1'000'000ull * n, 1'000'000ull * n + 1, cdr);
  }
  if (status.ok()) status = writer.close();
  if (!status.ok()) std::cerr << status.text << '\n';
  return status.ok() ? 0 : 1;
}

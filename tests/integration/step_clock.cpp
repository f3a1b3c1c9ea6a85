// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"

// step_clock IN OUT [AT_S BY_S]...: the recording that a recorder of before would have made if its
// clock, from which it took the log times, had been set by BY_S at AT_S.

namespace {

using namespace stillhand::recording;  // NOLINT(google-build-using-namespace): a program of one
                                       // file

constexpr double kNsPerSecond = 1e9;

std::int64_t ns(const char* text) {
  return static_cast<std::int64_t>(std::strtod(text, nullptr) * kNsPerSecond);
}

class SteppedCopy {
 public:
  SteppedCopy(McapReader& reader, McapWriter& writer,
              std::vector<std::pair<std::int64_t, std::int64_t>> steps)
      : reader_(reader), writer_(writer), steps_(std::move(steps)) {}

  bool write() {
    for (Metadata each : reader_.metadata()) {
      each.texts.erase("log_clock");  // earlier recorders did not write it
      for (auto& [key, text] : each.texts) {
        if (key == "clock_offset_ns at end")
          text = std::to_string(stepped(INT64_MAX) + std::stoll(text));
      }
      if (!writer_.add_metadata(each.name, each.texts).ok()) return false;
    }
    bool ok = true;
    const Status status =
        reader_.for_each_message({}, [&](const MessageView& message) { return ok = put(message); });
    return ok && status.ok() && writer_.close().ok();
  }

 private:
  // What the clock has been set by until an instant since the recording's start.
  [[nodiscard]] std::int64_t stepped(std::int64_t at_ns) const {
    std::int64_t by_ns = 0;
    for (const auto& [from_ns, step_ns] : steps_) by_ns += at_ns >= from_ns ? step_ns : 0;
    return by_ns;
  }

  bool put(const MessageView& message) {
    const auto [channel, fresh] = channels_.try_emplace(message.channel.id, ChannelId{0});
    if (fresh) {
      const auto schema = message.schema == nullptr
                              ? SchemaId{0}
                              : writer_.add_schema(message.schema->name, message.schema->encoding,
                                                   message.schema->bytes);
      channel->second =
          writer_.add_channel(message.channel.topic, schema, message.channel.message_encoding,
                              message.channel.metadata);
    }
    const std::uint64_t since_ns = message.log_time_ns - reader_.statistics().start_time_ns;
    // As a recorder flushes.
    if (since_ns / kFlush_ns != flushed_) {
      flushed_ = since_ns / kFlush_ns;
      if (!writer_.flush_chunk().ok()) return false;
    }
    const auto by_ns = static_cast<std::uint64_t>(stepped(static_cast<std::int64_t>(since_ns)));
    return writer_
        .write(channel->second, message.sequence, message.log_time_ns + by_ns,
               message.publish_time_ns + by_ns, message.bytes)
        .ok();
  }

  static constexpr std::uint64_t kFlush_ns = 500'000'000;
  McapReader& reader_;
  McapWriter& writer_;
  std::vector<std::pair<std::int64_t, std::int64_t>> steps_;
  std::map<ChannelId, ChannelId> channels_;
  std::uint64_t flushed_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || argc % 2 == 0) return 2;
  FileSource in(argv[1]);
  McapReader reader(in);
  FileSink out(argv[2]);
  McapWriter writer(out, {});
  std::vector<std::pair<std::int64_t, std::int64_t>> steps;
  for (int i = 3; i < argc; i += 2) steps.emplace_back(ns(argv[i]), ns(argv[i + 1]));
  if (!reader.status().ok() || !SteppedCopy(reader, writer, std::move(steps)).write()) {
    std::cerr << "step_clock: " << argv[1] << " is not copied\n";
    return 1;
  }
  return 0;
}

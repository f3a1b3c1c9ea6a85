// SPDX-License-Identifier: Apache-2.0
// Writing a recording to a file, next to a plain write() of the same messages, and reading it back:
//   build/tests/mcap_write_benchmark            files in /tmp, or in TMPDIR
//
// Messages are 92 bytes, the size of a Sensed sample in CDR, filled like one: a slow sine per
// field.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::recording {
namespace {

constexpr std::size_t kMessageBytes = 92;
constexpr std::size_t kBatch = 50'000;  // 50 s of one topic at 1 kHz

using Message = std::array<std::byte, kMessageBytes>;

const std::vector<Message>& messages() {
  static const std::vector<Message> all = [] {
    std::vector<Message> made(kBatch);
    for (std::size_t n = 0; n < kBatch; ++n) {
      for (std::size_t field = 0; 4 + 8 * (field + 1) <= kMessageBytes; ++field) {
        const double value = std::sin(1e-3 * static_cast<double>(n * (field + 1)));
        std::memcpy(made[n].data() + 4 + 8 * field, &value, sizeof(value));
      }
    }
    return made;
  }();
  return all;
}

std::string path(const char* name) {
  return (std::filesystem::temp_directory_path() / name).string();
}

void set_rates(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kBatch));
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(kBatch * kMessageBytes));
}

void plain_write(benchmark::State& state) {
  const std::string file = path("stillhand_plain.bin");
  for (auto _ : state) {
    FileSink sink(file, Existing::kReplace);
    for (const Message& message : messages()) {
      if (!sink.write(message).ok()) state.SkipWithError("write failed");
    }
  }
  set_rates(state);
  std::filesystem::remove(file);
}
BENCHMARK(plain_write)->Unit(benchmark::kMillisecond)->UseRealTime();

// The same bytes in pieces of a chunk's size: what the system itself takes.
void plain_write_in_blocks(benchmark::State& state) {
  const std::string file = path("stillhand_plain.bin");
  constexpr std::size_t kBlockBytes = 256 * 1024;
  const auto all = std::as_bytes(std::span(messages()));
  for (auto _ : state) {
    FileSink sink(file, Existing::kReplace);
    for (std::size_t at = 0; at < all.size(); at += kBlockBytes) {
      const auto block = all.subspan(at, std::min(kBlockBytes, all.size() - at));
      if (!sink.write(block).ok()) state.SkipWithError("write failed");
    }
  }
  set_rates(state);
  std::filesystem::remove(file);
}
BENCHMARK(plain_write_in_blocks)->Unit(benchmark::kMillisecond)->UseRealTime();

void write_all(ByteSink& sink, Compression compression, std::size_t chunk_bytes,
               benchmark::State& state) {
  McapWriter writer(sink, {chunk_bytes, compression});
  const auto channel = writer.add_channel("stillhand/sensed", 0, "cdr");
  std::uint32_t sequence = 0;
  for (const Message& message : messages()) {
    const std::uint64_t time_ns = 1'000'000ull * sequence;
    if (!writer.write(channel, sequence++, time_ns, time_ns, message).ok()) {
      state.SkipWithError("write failed");
    }
  }
  // No close(): it waits for the disk, which plain_write does not.
  if (!writer.flush_chunk().ok()) state.SkipWithError("write failed");
}

void mcap_write(benchmark::State& state) {
  const auto compression = static_cast<Compression>(state.range(0));
  const std::string file = path("stillhand_benchmark.mcap");
  std::uint64_t size = 0;
  for (auto _ : state) {
    FileSink sink(file, Existing::kReplace);
    write_all(sink, compression, static_cast<std::size_t>(state.range(1)) * 1024, state);
    size = sink.size();
  }
  set_rates(state);
  state.counters["file_bytes_per_message"] = static_cast<double>(size) / kBatch;
  state.SetLabel(std::string(compression_name(compression)));
  std::filesystem::remove(file);
}
BENCHMARK(mcap_write)
    ->ArgNames({"compression", "chunk_KiB"})
    ->ArgsProduct({{0, 1, 2}, {64, 256, 1024}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// The recorder's --fsync: each chunk waits for the disk.
void mcap_write_synced(benchmark::State& state) {
  const std::string file = path("stillhand_benchmark.mcap");
  for (auto _ : state) {
    FileSink sink(file, Existing::kReplace, Durability::kPower);
    write_all(sink, Compression::kZstd, 256 * 1024, state);
  }
  set_rates(state);
  std::filesystem::remove(file);
}
BENCHMARK(mcap_write_synced)->Unit(benchmark::kMillisecond)->UseRealTime();

void mcap_read(benchmark::State& state) {
  const auto compression = static_cast<Compression>(state.range(0));
  const std::string file = path("stillhand_benchmark.mcap");
  {
    FileSink sink(file, Existing::kReplace);
    write_all(sink, compression, 256 * 1024, state);
  }
  for (auto _ : state) {
    FileSource source(file);
    McapReader reader(source);  // scanned: the worse case, every chunk is unpacked twice
    std::uint64_t bytes = 0;
    const Status status = reader.for_each_message({}, [&](const MessageView& message) {
      bytes += message.bytes.size();
      return true;
    });
    if (!status.ok() || bytes != kBatch * kMessageBytes) state.SkipWithError("read failed");
  }
  set_rates(state);
  state.SetLabel(std::string(compression_name(compression)));
  std::filesystem::remove(file);
}
BENCHMARK(mcap_read)->ArgName("compression")->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

// By number of topics, uncompressed and closed with an index: recorder_peers.py.
void write_topics(ByteSink& sink, std::size_t topics, benchmark::State& state) {
  McapWriter writer(sink, {256 * 1024, Compression::kNone});
  std::vector<ChannelId> channels;
  for (std::size_t i = 0; i < topics; ++i) {
    channels.push_back(writer.add_channel("load/" + std::to_string(i), 0, "cdr"));
  }
  std::uint32_t sequence = 0;
  for (const Message& message : messages()) {
    const std::uint64_t time_ns = 1'000'000ull * sequence;
    const ChannelId channel = channels[sequence % topics];
    if (!writer.write(channel, sequence++, time_ns, time_ns, message).ok()) {
      state.SkipWithError("write failed");
    }
  }
  if (!writer.close().ok()) state.SkipWithError("write failed");
}

// In memory of the system's cache: the close() of a file waits for the disk.
class CachedSink : public ByteSink {
 public:
  explicit CachedSink(const std::string& file) : sink_(file, Existing::kReplace) {}
  Status write(std::span<const std::byte> bytes) override { return sink_.write(bytes); }
  Status flush() override { return {}; }
  [[nodiscard]] std::uint64_t size() const override { return sink_.size(); }

 private:
  FileSink sink_;
};

void mcap_write_topics(benchmark::State& state) {
  const std::string file = path("stillhand_benchmark.mcap");
  for (auto _ : state) {
    CachedSink sink(file);
    write_topics(sink, static_cast<std::size_t>(state.range(0)), state);
  }
  set_rates(state);
  std::filesystem::remove(file);
}
BENCHMARK(mcap_write_topics)
    ->ArgName("topics")
    ->RangeMultiplier(10)
    ->Range(1, 1000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void mcap_read_topics(benchmark::State& state) {
  const std::string file = path("stillhand_benchmark.mcap");
  {
    CachedSink sink(file);
    write_topics(sink, static_cast<std::size_t>(state.range(0)), state);
  }
  for (auto _ : state) {
    FileSource source(file);
    McapReader reader(source);
    std::uint64_t bytes = 0;
    const Status status = reader.for_each_message({}, [&](const MessageView& message) {
      bytes += message.bytes.size();
      return true;
    });
    if (!status.ok() || bytes != kBatch * kMessageBytes) state.SkipWithError("read failed");
  }
  set_rates(state);
  std::filesystem::remove(file);
}
BENCHMARK(mcap_read_topics)
    ->ArgName("topics")
    ->RangeMultiplier(10)
    ->Range(1, 1000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace stillhand::recording

BENCHMARK_MAIN();

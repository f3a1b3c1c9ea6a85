// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "services/core/recording/mcap/byte_stream.hpp"
#include "services/core/recording/mcap/compression.hpp"
#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

/// Settings of a writer.
struct McapWriterOptions {
  std::size_t chunk_bytes =
      std::size_t{256} * 1024;  ///< [B] size of the uncompressed records of a chunk
  Compression compression = Compression::kZstd;
  std::string library = "stillhand";
  std::string profile = kProfile;
  ChannelId first_channel = 0;  ///< the others count on
};

/// Writes one MCAP file as FORMAT.md describes.  It collects messages in a chunk and writes the
/// chunk to the sink at once, with checksum and index; close() appends the summary.
///
/// A crash loses at most the open chunk.  A failure while running is a Status; the writer keeps the
/// first failure of the sink, and every later call returns it.  The destructor does not close the
/// file; McapReader recovers a file without close().  The sink must outlive the writer.
/// Thread-compatible: one thread at a time.  Steady writing does not allocate.  Throws only
/// std::bad_alloc.
class McapWriter {
 public:
  static constexpr std::size_t kMaxIds = 65535;  ///< of schemas, and of channels
  static constexpr std::size_t kMaxMessageBytes = std::size_t{64} << 20;  ///< [B]

  /// Writes magic and header; status() and every later call return a failure.
  explicit McapWriter(ByteSink& sink, McapWriterOptions options = {});

  /// Registers a definition; at most kMaxIds.  @returns its number, from 1.
  SchemaId add_schema(std::string name, std::string encoding, std::span<const std::byte> bytes);
  /// Registers a definition given as text.
  SchemaId add_schema(std::string name, std::string encoding, std::string_view text);
  /// Registers a topic; at most kMaxIds.  @param schema_id from add_schema, or 0 for none.
  /// @returns its number, from 0.
  ChannelId add_channel(std::string topic, SchemaId schema_id, std::string message_encoding,
                        TextMap metadata = {});

  /// Appends one message; `channel` is from add_channel.  Times in ns of one clock of the caller.
  Status write(ChannelId channel, std::uint32_t sequence, std::uint64_t log_time_ns,
               std::uint64_t publish_time_ns, std::span<const std::byte> message);

  /// Writes the open chunk now, if it is not empty.  After this, a crash loses no earlier message.
  Status flush_chunk();

  /// Writes a metadata record now, outside the chunks; names need not be unique.
  Status add_metadata(const std::string& name, const TextMap& texts);

  /// Writes the open chunk, data end, summary and footer, and flushes the sink.  Call it once.
  Status close();

  /// First failure so far, or ok.
  [[nodiscard]] const Status& status() const noexcept { return status_; }
  /// Totals so far, the open chunk included.
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }

 private:
  struct ChannelState {
    Channel channel;
    std::vector<std::pair<std::uint64_t, std::uint64_t>> chunk_entries;  // log time, offset
    std::uint64_t message_count = 0;
    bool in_chunk = false;  // its Channel record is in the open chunk
    bool in_file = false;   // in the open chunk or an earlier one
  };

  Status emit();  // out_ to the sink, with the running checksum
  void define(ChannelState& state);
  void put_message_indexes(ChunkIndex& index);
  std::uint64_t put_summary();  // start of the summary offsets

  ByteSink& sink_;
  McapWriterOptions options_;
  Status status_;
  Compressor compressor_;
  std::vector<Schema> schemas_;
  std::vector<bool> schema_in_file_;
  std::vector<ChannelState> channels_;
  std::vector<ChunkIndex> chunk_indexes_;
  std::vector<std::pair<std::string, std::pair<std::uint64_t, std::uint64_t>>> metadata_places_;
  Statistics statistics_;
  std::vector<std::byte> chunk_;  // uncompressed records of the open chunk
  std::uint64_t chunk_start_ns_ = 0;
  std::uint64_t chunk_end_ns_ = 0;
  std::uint64_t chunk_messages_ = 0;
  std::vector<std::byte> out_;  // bytes on their way to the sink
  std::uint64_t position_ = 0;  // [B] written to the sink
  std::uint32_t data_crc_ = 0;
  bool closed_ = false;
};

}  // namespace stillhand::recording

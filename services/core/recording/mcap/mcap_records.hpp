// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "services/core/recording/mcap/mcap_format.hpp"
#include "services/core/recording/mcap/wire.hpp"

namespace stillhand::recording {

// Encoding and decoding of one record, without state.  put_* append a whole record.  parse_* take
// its content, ignore fields of a later version (`extra_bytes`) and return nullopt if a field does
// not fit.

void put_schema(Bytes& out, const Schema& schema);
void put_channel(Bytes& out, const Channel& channel);
void put_metadata(Bytes& out, const std::string& name, const TextMap& texts);
void put_chunk_index(Bytes& out, const ChunkIndex& index);
void put_statistics(Bytes& out, const Statistics& statistics);

/// A parsed record and the number of unknown bytes at the end of its content.
template <typename Record>
struct Parsed {
  Record record;
  std::uint64_t extra_bytes = 0;
};

std::optional<Parsed<Schema>> parse_schema(std::span<const std::byte> content);
std::optional<Parsed<Channel>> parse_channel(std::span<const std::byte> content);
std::optional<Parsed<Metadata>> parse_metadata(std::span<const std::byte> content);
std::optional<ChunkIndex> parse_chunk_index(std::span<const std::byte> content);
std::optional<Statistics> parse_statistics(std::span<const std::byte> content);

/// Fields of a Chunk before its packed records.
struct ChunkHead {
  std::uint64_t start_time_ns = 0;
  std::uint64_t end_time_ns = 0;
  std::uint64_t uncompressed_size = 0;
  std::uint32_t uncompressed_crc = 0;
  std::string compression;
  std::uint64_t packed_size = 0;

  /// Length of the content, computed from the fields.
  [[nodiscard]] std::uint64_t content_bytes() const noexcept {
    return kChunkFixedBytes + compression.size() + packed_size;
  }
};

/// Longest prefix of a chunk's content that parse_chunk_head() reads.
inline constexpr std::uint64_t kChunkHeadBytes = kChunkFixedBytes + 32;

/// @param prefix  start of the content, with at least kChunkHeadBytes if the content has them
/// @param content_length  of the whole record; the packed records must lie inside.
std::optional<ChunkHead> parse_chunk_head(std::span<const std::byte> prefix,
                                          std::uint64_t content_length);

/// Content of the Footer.
struct Footer {
  std::uint64_t summary_start = 0;         ///< 0: there is no summary
  std::uint64_t summary_offset_start = 0;  ///< 0: there are no summary offsets
  std::uint32_t summary_crc = 0;           ///< 0: not known
};

/// The last kFooterAndMagicBytes of a file, footer record and magic.
std::optional<Footer> parse_footer_and_magic(std::span<const std::byte> tail);

}  // namespace stillhand::recording

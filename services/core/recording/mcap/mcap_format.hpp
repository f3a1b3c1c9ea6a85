// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace stillhand::recording {

// The MCAP container, major version 0 (mcap.dev/spec).  services/core/recording/FORMAT.md has the
// grammar of Stillhand's files, a worked example byte by byte, and the rules of recovery.

/// First and last eight bytes of every file.
inline constexpr std::array<std::uint8_t, 8> kMagic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

/// First byte of a record; a 64-bit little-endian content length follows, then the content.
enum class Opcode : std::uint8_t {
  kHeader = 0x01,
  kFooter = 0x02,
  kSchema = 0x03,
  kChannel = 0x04,
  kMessage = 0x05,
  kChunk = 0x06,
  kMessageIndex = 0x07,
  kChunkIndex = 0x08,
  kAttachment = 0x09,
  kAttachmentIndex = 0x0A,
  kStatistics = 0x0B,
  kMetadata = 0x0C,
  kMetadataIndex = 0x0D,
  kSummaryOffset = 0x0E,
  kDataEnd = 0x0F,
};

inline constexpr std::uint64_t kRecordHeadBytes = 9;    ///< opcode and content length
inline constexpr std::uint64_t kMessageHeadBytes = 22;  ///< content of a Message before its data
inline constexpr std::uint64_t kChunkFixedBytes = 40;  ///< content of a Chunk without its two texts
inline constexpr std::uint64_t kFooterContentBytes = 20;  ///< the Footer is never extended
inline constexpr std::uint64_t kFooterAndMagicBytes = kRecordHeadBytes + kFooterContentBytes + 8;

/// Values that Stillhand writes; its reader accepts any value.
inline constexpr const char* kProfile = "x-stillhand";
inline constexpr const char* kMessageEncoding = "cdr";
inline constexpr const char* kSchemaEncoding = "omgidl";

using TextMap = std::map<std::string, std::string>;
using SchemaId = std::uint16_t;  ///< 0 means "no schema"
using ChannelId = std::uint16_t;

/// Compression of the records of a chunk.
enum class Compression : std::uint8_t { kNone, kLz4, kZstd };

/// Definition of a message type.
struct Schema {
  SchemaId id = 0;
  std::string name;              ///< for example "stillhand_msgs::Sensed"
  std::string encoding;          ///< "omgidl" in our files
  std::vector<std::byte> bytes;  ///< the definition itself
  bool operator==(const Schema&) const = default;
};

/// One topic of a recording.
struct Channel {
  ChannelId id = 0;
  SchemaId schema_id = 0;
  std::string topic;
  std::string message_encoding;  ///< "cdr" in our files
  TextMap metadata;
  bool operator==(const Channel&) const = default;
};

/// Named texts of a recording: seed, settings, host, program version.
struct Metadata {
  std::string name;
  TextMap texts;
  bool operator==(const Metadata&) const = default;
};

/// Place and extent of one chunk.
struct ChunkIndex {
  std::uint64_t start_time_ns = 0;  ///< earliest log time inside, 0 without messages
  std::uint64_t end_time_ns = 0;    ///< latest log time inside
  std::uint64_t offset = 0;         ///< [B] of the chunk record in the file
  std::uint64_t length = 0;         ///< [B] of the chunk record, opcode and length included
  std::map<ChannelId, std::uint64_t> message_index_offsets;
  std::uint64_t message_index_length = 0;
  std::string compression;
  std::uint64_t compressed_size = 0;
  std::uint64_t uncompressed_size = 0;
};

/// Totals of a file.
struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0;
  std::uint32_t attachment_count = 0;
  std::uint32_t metadata_count = 0;
  std::uint32_t chunk_count = 0;
  std::uint64_t start_time_ns = 0;  ///< earliest log time, 0 without messages
  std::uint64_t end_time_ns = 0;    ///< latest log time
  std::map<ChannelId, std::uint64_t> channel_message_counts;
  bool operator==(const Statistics&) const = default;
};

}  // namespace stillhand::recording

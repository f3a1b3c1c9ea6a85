// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_records.hpp"

#include <algorithm>

namespace stillhand::recording {
namespace {

constexpr std::uint32_t kIdMapEntryBytes = 10;  // 16-bit key, 64-bit value

void put_id_map(Bytes& out, const std::map<ChannelId, std::uint64_t>& values) {
  put(out, static_cast<std::uint32_t>(values.size() * kIdMapEntryBytes));
  for (const auto& [id, value] : values) {
    put(out, id);
    put(out, value);
  }
}

std::map<ChannelId, std::uint64_t> take_id_map(WireReader& in) {
  std::map<ChannelId, std::uint64_t> values;
  WireReader entries(in.take_bytes(in.take<std::uint32_t>()));
  while (entries.left() >= kIdMapEntryBytes) {
    const auto id = entries.take<std::uint16_t>();
    values[id] = entries.take<std::uint64_t>();
  }
  return values;
}

template <typename Record>
std::optional<Parsed<Record>> parsed(const WireReader& in, Record record) {
  if (!in.ok()) return std::nullopt;
  return Parsed<Record>{std::move(record), in.left()};
}

}  // namespace

void put_schema(Bytes& out, const Schema& schema) {
  const std::size_t mark = begin_record(out, Opcode::kSchema);
  put(out, schema.id);
  put_text(out, schema.name);
  put_text(out, schema.encoding);
  put(out, static_cast<std::uint32_t>(schema.bytes.size()));
  put_bytes(out, schema.bytes);
  end_record(out, mark);
}

void put_channel(Bytes& out, const Channel& channel) {
  const std::size_t mark = begin_record(out, Opcode::kChannel);
  put(out, channel.id);
  put(out, channel.schema_id);
  put_text(out, channel.topic);
  put_text(out, channel.message_encoding);
  put_map(out, channel.metadata);
  end_record(out, mark);
}

void put_metadata(Bytes& out, const std::string& name, const TextMap& texts) {
  const std::size_t mark = begin_record(out, Opcode::kMetadata);
  put_text(out, name);
  put_map(out, texts);
  end_record(out, mark);
}

void put_chunk_index(Bytes& out, const ChunkIndex& index) {
  const std::size_t mark = begin_record(out, Opcode::kChunkIndex);
  put(out, index.start_time_ns);
  put(out, index.end_time_ns);
  put(out, index.offset);
  put(out, index.length);
  put_id_map(out, index.message_index_offsets);
  put(out, index.message_index_length);
  put_text(out, index.compression);
  put(out, index.compressed_size);
  put(out, index.uncompressed_size);
  end_record(out, mark);
}

void put_statistics(Bytes& out, const Statistics& statistics) {
  const std::size_t mark = begin_record(out, Opcode::kStatistics);
  put(out, statistics.message_count);
  put(out, statistics.schema_count);
  put(out, statistics.channel_count);
  put(out, statistics.attachment_count);
  put(out, statistics.metadata_count);
  put(out, statistics.chunk_count);
  put(out, statistics.start_time_ns);
  put(out, statistics.end_time_ns);
  put_id_map(out, statistics.channel_message_counts);
  end_record(out, mark);
}

std::optional<Parsed<Schema>> parse_schema(std::span<const std::byte> content) {
  WireReader in(content);
  Schema schema;
  schema.id = in.take<std::uint16_t>();
  schema.name = in.take_text();
  schema.encoding = in.take_text();
  const auto bytes = in.take_bytes(in.take<std::uint32_t>());
  schema.bytes.assign(bytes.begin(), bytes.end());
  return parsed(in, std::move(schema));
}

std::optional<Parsed<Channel>> parse_channel(std::span<const std::byte> content) {
  WireReader in(content);
  Channel channel;
  channel.id = in.take<std::uint16_t>();
  channel.schema_id = in.take<std::uint16_t>();
  channel.topic = in.take_text();
  channel.message_encoding = in.take_text();
  channel.metadata = in.take_map();
  return parsed(in, std::move(channel));
}

std::optional<Parsed<Metadata>> parse_metadata(std::span<const std::byte> content) {
  WireReader in(content);
  Metadata metadata;
  metadata.name = in.take_text();
  metadata.texts = in.take_map();
  return parsed(in, std::move(metadata));
}

std::optional<ChunkIndex> parse_chunk_index(std::span<const std::byte> content) {
  WireReader in(content);
  ChunkIndex index;
  index.start_time_ns = in.take<std::uint64_t>();
  index.end_time_ns = in.take<std::uint64_t>();
  index.offset = in.take<std::uint64_t>();
  index.length = in.take<std::uint64_t>();
  index.message_index_offsets = take_id_map(in);
  index.message_index_length = in.take<std::uint64_t>();
  index.compression = in.take_text();
  index.compressed_size = in.take<std::uint64_t>();
  index.uncompressed_size = in.take<std::uint64_t>();
  if (!in.ok()) return std::nullopt;
  return index;
}

std::optional<Statistics> parse_statistics(std::span<const std::byte> content) {
  WireReader in(content);
  Statistics statistics;
  statistics.message_count = in.take<std::uint64_t>();
  statistics.schema_count = in.take<std::uint16_t>();
  statistics.channel_count = in.take<std::uint32_t>();
  statistics.attachment_count = in.take<std::uint32_t>();
  statistics.metadata_count = in.take<std::uint32_t>();
  statistics.chunk_count = in.take<std::uint32_t>();
  statistics.start_time_ns = in.take<std::uint64_t>();
  statistics.end_time_ns = in.take<std::uint64_t>();
  statistics.channel_message_counts = take_id_map(in);
  if (!in.ok()) return std::nullopt;
  return statistics;
}

std::optional<ChunkHead> parse_chunk_head(std::span<const std::byte> prefix,
                                          std::uint64_t content_length) {
  WireReader in(prefix);
  ChunkHead head;
  head.start_time_ns = in.take<std::uint64_t>();
  head.end_time_ns = in.take<std::uint64_t>();
  head.uncompressed_size = in.take<std::uint64_t>();
  head.uncompressed_crc = in.take<std::uint32_t>();
  head.compression = in.take_text();
  head.packed_size = in.take<std::uint64_t>();
  if (!in.ok()) return std::nullopt;
  const std::uint64_t before_packed = kChunkFixedBytes + head.compression.size();
  if (before_packed > content_length || head.packed_size > content_length - before_packed) {
    return std::nullopt;
  }
  return head;
}

std::optional<Footer> parse_footer_and_magic(std::span<const std::byte> tail) {
  WireReader in(tail);
  const auto opcode = static_cast<Opcode>(in.take<std::uint8_t>());
  const auto length = in.take<std::uint64_t>();
  Footer footer;
  footer.summary_start = in.take<std::uint64_t>();
  footer.summary_offset_start = in.take<std::uint64_t>();
  footer.summary_crc = in.take<std::uint32_t>();
  const auto magic = in.take_bytes(kMagic.size());
  if (!in.ok() || opcode != Opcode::kFooter || length != kFooterContentBytes ||
      !std::ranges::equal(magic, std::as_bytes(std::span(kMagic)))) {
    return std::nullopt;
  }
  return footer;
}

}  // namespace stillhand::recording

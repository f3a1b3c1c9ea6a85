// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_records.hpp"

#include <algorithm>
#include <concepts>
#include <tuple>

namespace stillhand::recording {
namespace {

template <typename T, typename Record>
concept Is = std::same_as<std::remove_const_t<T>, Record>;

// The fields of a record in their order in the file, for both ways.
auto fields(Is<Schema> auto& of) { return std::tie(of.id, of.name, of.encoding, of.bytes); }
auto fields(Is<Channel> auto& of) {
  return std::tie(of.id, of.schema_id, of.topic, of.message_encoding, of.metadata);
}
auto fields(Is<Metadata> auto& of) { return std::tie(of.name, of.texts); }
auto fields(Is<ChunkIndex> auto& of) {
  return std::tie(of.start_time_ns, of.end_time_ns, of.offset, of.length, of.message_index_offsets,
                  of.message_index_length, of.compression, of.compressed_size,
                  of.uncompressed_size);
}
auto fields(Is<Statistics> auto& of) {
  return std::tie(of.message_count, of.schema_count, of.channel_count, of.attachment_count,
                  of.metadata_count, of.chunk_count, of.start_time_ns, of.end_time_ns,
                  of.channel_message_counts);
}
auto fields(Is<ChunkHead> auto& of) {
  return std::tie(of.start_time_ns, of.end_time_ns, of.uncompressed_size, of.uncompressed_crc,
                  of.compression, of.packed_size);
}

using IdMap = std::map<ChannelId, std::uint64_t>;
constexpr std::uint32_t kIdMapEntryBytes = 10;  // 16-bit key, 64-bit value

void write(Bytes& out, std::unsigned_integral auto field) { put(out, field); }
void write(Bytes& out, const std::string& field) { put_text(out, field); }
void write(Bytes& out, const TextMap& field) { put_map(out, field); }
void write(Bytes& out, const Bytes& field) {
  put(out, static_cast<std::uint32_t>(field.size()));
  put_bytes(out, field);
}
void write(Bytes& out, const IdMap& field) {
  put(out, static_cast<std::uint32_t>(field.size() * kIdMapEntryBytes));
  for (const auto& [id, value] : field) {
    put(out, id);
    put(out, value);
  }
}

template <std::unsigned_integral T>
void read(WireReader& in, T& field) {
  field = in.take<T>();
}
void read(WireReader& in, std::string& field) { field = in.take_text(); }
void read(WireReader& in, TextMap& field) { field = in.take_map(); }
void read(WireReader& in, Bytes& field) {
  const auto bytes = in.take_bytes(in.take<std::uint32_t>());
  field.assign(bytes.begin(), bytes.end());
}
void read(WireReader& in, IdMap& field) {
  WireReader entries(in.take_bytes(in.take<std::uint32_t>()));
  while (entries.left() >= kIdMapEntryBytes) {
    const auto id = entries.take<std::uint16_t>();
    field[id] = entries.take<std::uint64_t>();
  }
}

template <typename Record>
void put_record(Bytes& out, Opcode opcode, const Record& record) {
  const std::size_t mark = begin_record(out, opcode);
  std::apply([&](const auto&... field) { (write(out, field), ...); }, fields(record));
  end_record(out, mark);
}

template <typename Record>
std::optional<Parsed<Record>> parsed(std::span<const std::byte> content) {
  WireReader in(content);
  Record record;
  std::apply([&](auto&... field) { (read(in, field), ...); }, fields(record));
  if (!in.ok()) return std::nullopt;
  return Parsed<Record>{std::move(record), in.left()};
}

template <typename Record>
std::optional<Record> record_of(std::span<const std::byte> content) {
  auto found = parsed<Record>(content);
  if (!found) return std::nullopt;
  return std::move(found->record);
}

}  // namespace

void put_schema(Bytes& out, const Schema& schema) { put_record(out, Opcode::kSchema, schema); }

void put_channel(Bytes& out, const Channel& channel) { put_record(out, Opcode::kChannel, channel); }

void put_metadata(Bytes& out, const std::string& name, const TextMap& texts) {
  put_record(out, Opcode::kMetadata, Metadata{name, texts});
}

void put_chunk_index(Bytes& out, const ChunkIndex& index) {
  put_record(out, Opcode::kChunkIndex, index);
}

void put_statistics(Bytes& out, const Statistics& statistics) {
  put_record(out, Opcode::kStatistics, statistics);
}

std::optional<Parsed<Schema>> parse_schema(std::span<const std::byte> content) {
  return parsed<Schema>(content);
}

std::optional<Parsed<Channel>> parse_channel(std::span<const std::byte> content) {
  return parsed<Channel>(content);
}

std::optional<Parsed<Metadata>> parse_metadata(std::span<const std::byte> content) {
  return parsed<Metadata>(content);
}

std::optional<ChunkIndex> parse_chunk_index(std::span<const std::byte> content) {
  return record_of<ChunkIndex>(content);
}

std::optional<Statistics> parse_statistics(std::span<const std::byte> content) {
  return record_of<Statistics>(content);
}

std::optional<ChunkHead> parse_chunk_head(std::span<const std::byte> prefix,
                                          std::uint64_t content_length) {
  auto head = record_of<ChunkHead>(prefix);
  if (!head) return std::nullopt;
  const std::uint64_t before_packed = kChunkFixedBytes + head->compression.size();
  if (before_packed > content_length || head->packed_size > content_length - before_packed) {
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

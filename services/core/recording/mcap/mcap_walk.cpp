// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "services/core/recording/mcap/compression.hpp"
#include "services/core/recording/mcap/crc32.hpp"
#include "services/core/recording/mcap/mcap_pass.hpp"
#include "services/core/recording/mcap/mcap_records.hpp"

namespace stillhand::recording {

// Counts the statistics without a summary, and reads every definition.
void McapReader::count_messages() {
  const MessageFilter everything;
  Statistics& counted = statistics_;
  const std::function<bool(const MessageView&)> count = [&](const MessageView& message) {
    const bool first = counted.message_count++ == 0;
    const std::uint64_t time_ns = message.log_time_ns;
    counted.start_time_ns = first ? time_ns : std::min(counted.start_time_ns, time_ns);
    counted.end_time_ns = std::max(counted.end_time_ns, time_ns);
    ++counted.channel_message_counts[message.channel.id];
    return true;
  };
  Pass pass{everything, count};
  walk(pass);
  counted.schema_count = static_cast<std::uint16_t>(schemas_.size());
  counted.channel_count = static_cast<std::uint32_t>(channels_.size());
  counted.metadata_count = static_cast<std::uint32_t>(metadata_.size());
  counted.chunk_count =
      static_cast<std::uint32_t>(std::ranges::count_if(pieces_, &Piece::is_chunk));
}

Status McapReader::for_each_message(const MessageFilter& filter,
                                    const std::function<bool(const MessageView&)>& take) {
  if (!status_.ok()) return status_;
  Pass pass{filter, take};
  walk(pass);
  return status_;
}

void McapReader::walk(Pass& pass) {
  for (const Piece& piece : pieces_) {
    if (pass.stopped || !status_.ok()) return;
    if (piece.start_time_ns > pass.filter.end_time_ns ||
        piece.end_time_ns < pass.filter.start_time_ns) {
      continue;
    }
    walk_piece(piece, pass);
  }
}

void McapReader::walk_piece(const Piece& piece, Pass& pass) {
  pass.unknown_bytes = 0;
  pass.message = 0;
  pass.newest_ns.reset();
  piece.is_chunk ? walk_chunk(piece, pass) : walk_loose(piece, pass);
  if (pass.unknown_bytes > 0) {
    add_damage(DamageKind::kUnknownChannel, piece.offset, pass.unknown_bytes,
               "messages of an undefined channel");
  }
}

// The records of a chunk; nullopt adds a damage.
std::optional<std::span<const std::byte>> McapReader::unpack_chunk(const Piece& piece) {
  const auto lost = [&](DamageKind kind, std::string text) {
    add_damage(kind, piece.offset, piece.length, "chunk lost: " + std::move(text));
    return std::nullopt;
  };
  if (piece.length > options_.max_chunk_bytes) {
    return lost(DamageKind::kTooLarge, "larger than the reader may load");
  }
  packed_.resize(static_cast<std::size_t>(piece.length));
  status_ = source_.read_at(piece.offset, packed_);
  if (!status_.ok()) return std::nullopt;
  WireReader record(packed_);
  const auto opcode = static_cast<Opcode>(record.take<std::uint8_t>());
  const auto length = record.take<std::uint64_t>();
  const bool contradicts = opcode != Opcode::kChunk || length != piece.length - kRecordHeadBytes;
  if (contradicts) {
    add_damage(DamageKind::kBadRecord, piece.offset, 0,
               "the head of a chunk contradicts the index; the index is used");
  }
  const auto content = std::span<const std::byte>(packed_).subspan(kRecordHeadBytes);
  const auto head = parse_chunk_head(content, content.size());
  if (!head) return lost(DamageKind::kBadChunk, "its fields contradict its length");
  // Zeros are also a head: of a chunk without record, compression or checksum.
  if (head->uncompressed_crc == 0 && (contradicts || head->content_bytes() != content.size())) {
    return lost(DamageKind::kBadChunk,
                "its fields contradict its length, and no checksum proves it");
  }
  if (head->uncompressed_size > options_.max_chunk_bytes) {
    return lost(DamageKind::kTooLarge, "unpacks to more than the reader may load");
  }
  const auto compression = compression_of(head->compression);
  if (!compression) return lost(DamageKind::kBadChunk, "unknown compression");
  compressions_.insert(*compression);
  const auto packed = content.subspan(kChunkFixedBytes + head->compression.size(),
                                      static_cast<std::size_t>(head->packed_size));
  const Status unpacked = unpack(*compression, packed, head->uncompressed_size, unpacked_);
  if (!unpacked.ok()) return lost(DamageKind::kBadChunk, unpacked.text);
  if (head->uncompressed_crc != 0 && crc32(unpacked_) != head->uncompressed_crc) {
    return lost(DamageKind::kBadChunk, "its checksum differs");
  }
  return unpacked_;
}

void McapReader::walk_chunk(const Piece& piece, Pass& pass) {
  auto records = unpack_chunk(piece);
  if (!records) return;
  RecordView record{};
  while (!pass.stopped && take_record(*records, record)) {
    walk_record(record.opcode, record.content, piece.offset, pass);
  }
  if (!pass.stopped && !records->empty()) {
    add_damage(DamageKind::kBadRecord, piece.offset, records->size(),
               "the last " + std::to_string(records->size()) +
                   " bytes of this chunk are not whole records");
  }
}

// The scan has checked that the piece consists of whole records, each within the limits.
void McapReader::walk_loose(const Piece& piece, Pass& pass) {
  std::uint64_t offset = piece.offset;
  const std::uint64_t end = piece.offset + piece.length;
  while (!pass.stopped && offset < end) {
    WireReader head(window_.view(offset, kRecordHeadBytes));
    const auto opcode = static_cast<Opcode>(head.take<std::uint8_t>());
    const std::uint64_t total = kRecordHeadBytes + head.take<std::uint64_t>();
    const auto record = window_.view(offset, total);
    if (record.empty()) {
      status_ = window_.status();
      return;
    }
    walk_record(opcode, record.subspan(kRecordHeadBytes), offset, pass);
    offset += total;
  }
}

void McapReader::walk_record(Opcode opcode, std::span<const std::byte> content,
                             std::uint64_t offset, Pass& pass) {
  if (opcode == Opcode::kSchema && !indexed_) {
    if (auto schema = parse_schema(content)) define(std::move(schema->record), offset);
  } else if (opcode == Opcode::kChannel && !indexed_) {
    if (auto channel = parse_channel(content)) define(std::move(channel->record), offset);
  }
  if (opcode != Opcode::kMessage) return;
  WireReader in(content);
  const auto id = in.take<std::uint16_t>();
  const auto sequence = in.take<std::uint32_t>();
  auto log_time_ns = in.take<std::uint64_t>();
  const auto publish_time_ns = in.take<std::uint64_t>();
  if (!in.ok()) {
    add_damage(DamageKind::kBadRecord, offset, content.size(), "message record too short");
    return;
  }
  const Pass::Topic& topic = pass.topic(*this, id);
  if (topic.channel == nullptr) {
    pass.unknown_bytes += kRecordHeadBytes + content.size();
    return;
  }
  if (pass.finder != nullptr) {
    pass.finder->take(offset, pass.message, id, topic.stream, log_time_ns,
                      content.subspan(kMessageHeadBytes));
  }
  if (!clock_steps_.empty()) log_time_ns = straight_time_ns(log_time_ns, offset, pass);
  ++pass.message;
  if (!topic.wanted || log_time_ns < pass.filter.start_time_ns ||
      log_time_ns > pass.filter.end_time_ns) {
    return;
  }
  pass.stopped = !pass.take({*topic.channel, topic.schema, sequence, log_time_ns, publish_time_ns,
                             content.subspan(kMessageHeadBytes)});
}

}  // namespace stillhand::recording

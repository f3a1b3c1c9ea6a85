// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_writer.hpp"

#include <algorithm>

#include "services/core/contract/expects.hpp"
#include "services/core/recording/mcap/crc32.hpp"
#include "services/core/recording/mcap/mcap_records.hpp"

namespace stillhand::recording {
namespace {

// A message index counts its bytes in 32 bits; this limit keeps a chunk of one message far below.

}  // namespace

McapWriter::McapWriter(ByteSink& sink, McapWriterOptions options)
    : sink_(sink), options_(std::move(options)), compressor_(options_.compression) {
  chunk_.reserve(options_.chunk_bytes + options_.chunk_bytes / 8 + 4096);
  put_bytes(out_, std::as_bytes(std::span(kMagic)));
  const std::size_t mark = begin_record(out_, Opcode::kHeader);
  put_text(out_, options_.profile);
  put_text(out_, options_.library);
  end_record(out_, mark);
  (void)emit();
}

Status McapWriter::emit() {
  if (status_.ok()) {
    status_ = sink_.write(out_);
    data_crc_ = crc32(out_, data_crc_);
    position_ += out_.size();
  }
  out_.clear();
  return status_;
}

SchemaId McapWriter::add_schema(std::string name, std::string encoding,
                                std::span<const std::byte> bytes) {
  STILLHAND_EXPECTS(!closed_ && schemas_.size() < kMaxIds);
  const auto id = static_cast<SchemaId>(schemas_.size() + 1);
  schemas_.push_back({id, std::move(name), std::move(encoding), {bytes.begin(), bytes.end()}});
  schema_in_file_.push_back(false);
  statistics_.schema_count = id;
  return id;
}

SchemaId McapWriter::add_schema(std::string name, std::string encoding, std::string_view text) {
  return add_schema(std::move(name), std::move(encoding), std::as_bytes(std::span(text)));
}

ChannelId McapWriter::add_channel(std::string topic, SchemaId schema_id,
                                  std::string message_encoding, TextMap metadata) {
  STILLHAND_EXPECTS(!closed_ && channels_.size() + options_.first_channel < kMaxIds &&
                    schema_id <= schemas_.size());
  const auto id = static_cast<ChannelId>(channels_.size() + options_.first_channel);
  ChannelState& state = channels_.emplace_back();
  state.channel = {id, schema_id, std::move(topic), std::move(message_encoding),
                   std::move(metadata)};
  statistics_.channel_count = static_cast<std::uint32_t>(channels_.size());
  return id;
}

// Every chunk repeats the Channel records that it needs, so it can be read if all others are lost.
// Schemas are long and occur once (and again in the summary).
void McapWriter::define(ChannelState& state) {
  if (state.in_chunk) return;
  const SchemaId schema_id = state.channel.schema_id;
  if (schema_id != 0 && !schema_in_file_[schema_id - 1U]) {
    put_schema(chunk_, schemas_[schema_id - 1U]);
    schema_in_file_[schema_id - 1U] = true;
  }
  put_channel(chunk_, state.channel);
  state.in_chunk = true;
  state.in_file = true;
}

Status McapWriter::write(ChannelId channel, std::uint32_t sequence, std::uint64_t log_time_ns,
                         std::uint64_t publish_time_ns, std::span<const std::byte> message) {
  const std::size_t place = std::size_t{channel} - options_.first_channel;
  STILLHAND_EXPECTS(place < channels_.size());
  if (!status_.ok()) return status_;
  if (closed_) return Status::failure(StatusKind::kClosed, "recording is closed");
  if (message.size() > kMaxMessageBytes) {
    return Status::failure(StatusKind::kTooLarge, "message of " + std::to_string(message.size()) +
                                                      " bytes, at most " +
                                                      std::to_string(kMaxMessageBytes));
  }
  ChannelState& state = channels_[place];
  define(state);
  state.chunk_entries.emplace_back(log_time_ns, chunk_.size());
  put(chunk_, static_cast<std::uint8_t>(Opcode::kMessage));
  put(chunk_, kMessageHeadBytes + message.size());
  put(chunk_, channel);
  put(chunk_, sequence);
  put(chunk_, log_time_ns);
  put(chunk_, publish_time_ns);
  put_bytes(chunk_, message);

  chunk_start_ns_ = chunk_messages_ == 0 ? log_time_ns : std::min(chunk_start_ns_, log_time_ns);
  chunk_end_ns_ = std::max(chunk_end_ns_, log_time_ns);
  ++chunk_messages_;
  Statistics& totals = statistics_;
  totals.start_time_ns =
      totals.message_count == 0 ? log_time_ns : std::min(totals.start_time_ns, log_time_ns);
  totals.end_time_ns = std::max(totals.end_time_ns, log_time_ns);
  ++totals.message_count;
  ++state.message_count;
  return chunk_.size() >= options_.chunk_bytes ? flush_chunk() : Status{};
}

// After a chunk: one message index for each channel, in the order of the channels.
void McapWriter::put_message_indexes(ChunkIndex& index) {
  const std::size_t start = out_.size();
  for (ChannelState& state : channels_) {
    if (!state.chunk_entries.empty()) {
      index.message_index_offsets[state.channel.id] = position_ + out_.size();
      const std::size_t mark = begin_record(out_, Opcode::kMessageIndex);
      put(out_, state.channel.id);
      put(out_, static_cast<std::uint32_t>(state.chunk_entries.size() * 16));
      for (const auto& [log_time_ns, offset] : state.chunk_entries) {
        put(out_, log_time_ns);
        put(out_, offset);
      }
      end_record(out_, mark);
    }
    state.chunk_entries.clear();
    state.in_chunk = false;
  }
  index.message_index_length = out_.size() - start;
}

Status McapWriter::flush_chunk() {
  if (!status_.ok() || chunk_.empty()) return status_;
  ChunkIndex index;
  index.start_time_ns = chunk_start_ns_;
  index.end_time_ns = chunk_end_ns_;
  index.offset = position_;
  index.compression = compression_name(options_.compression);
  index.uncompressed_size = chunk_.size();
  const std::size_t mark = begin_record(out_, Opcode::kChunk);
  put(out_, index.start_time_ns);
  put(out_, index.end_time_ns);
  put(out_, index.uncompressed_size);
  put(out_, crc32(chunk_));
  put_text(out_, index.compression);
  const std::size_t size_mark = out_.size();
  put(out_, std::uint64_t{0});
  status_ = compressor_.append(chunk_, out_);
  if (!status_.ok()) return status_;
  end_record(
      out_, size_mark);  // the packed records have their length field at the same place as a record
  end_record(out_, mark);
  index.compressed_size = out_.size() - size_mark - 8;
  index.length = out_.size();
  put_message_indexes(index);
  chunk_indexes_.push_back(std::move(index));
  statistics_.chunk_count = static_cast<std::uint32_t>(chunk_indexes_.size());
  chunk_.clear();
  chunk_messages_ = chunk_start_ns_ = chunk_end_ns_ = 0;
  return emit();
}

Status McapWriter::add_metadata(const std::string& name, const TextMap& texts) {
  if (!status_.ok()) return status_;
  if (closed_) return Status::failure(StatusKind::kClosed, "recording is closed");
  put_metadata(out_, name, texts);
  metadata_places_.push_back({name, {position_, out_.size()}});
  ++statistics_.metadata_count;
  return emit();
}

// Writes the summary into out_: groups of one opcode each, then the place of each group.
std::uint64_t McapWriter::put_summary() {
  std::vector<std::pair<Opcode, std::size_t>> groups;  // opcode, end in out_
  for (const Schema& schema : schemas_) put_schema(out_, schema);
  groups.emplace_back(Opcode::kSchema, out_.size());
  for (const ChannelState& state : channels_) put_channel(out_, state.channel);
  groups.emplace_back(Opcode::kChannel, out_.size());
  put_statistics(out_, statistics_);
  groups.emplace_back(Opcode::kStatistics, out_.size());
  for (const ChunkIndex& index : chunk_indexes_) put_chunk_index(out_, index);
  groups.emplace_back(Opcode::kChunkIndex, out_.size());
  for (const auto& [name, place] : metadata_places_) {
    const std::size_t mark = begin_record(out_, Opcode::kMetadataIndex);
    put(out_, place.first);
    put(out_, place.second);
    put_text(out_, name);
    end_record(out_, mark);
  }
  groups.emplace_back(Opcode::kMetadataIndex, out_.size());
  const std::uint64_t offsets_start = position_ + out_.size();
  std::size_t start = 0;
  for (const auto& [opcode, end] : groups) {
    if (end > start) {
      const std::size_t mark = begin_record(out_, Opcode::kSummaryOffset);
      put(out_, static_cast<std::uint8_t>(opcode));
      put(out_, position_ + start);
      put(out_, static_cast<std::uint64_t>(end - start));
      end_record(out_, mark);
    }
    start = end;
  }
  return offsets_start;
}

Status McapWriter::close() {
  if (closed_) return Status::failure(StatusKind::kClosed, "recording is closed");
  closed_ = true;
  // A topic without a message and a schema without a topic are also part of the recording.
  for (const Schema& schema : schemas_) {
    if (!schema_in_file_[schema.id - 1U]) put_schema(chunk_, schema);
    schema_in_file_[schema.id - 1U] = true;
  }
  for (ChannelState& state : channels_) {
    if (!state.in_file) define(state);
    if (state.message_count > 0) {
      statistics_.channel_message_counts[state.channel.id] = state.message_count;
    }
  }
  if (Status flushed = flush_chunk(); !flushed.ok()) return flushed;
  const std::uint32_t data_crc = data_crc_;
  const std::size_t data_end = begin_record(out_, Opcode::kDataEnd);
  put(out_, data_crc);
  end_record(out_, data_end);
  if (Status ended = emit(); !ended.ok()) return ended;

  const std::uint64_t summary_start = position_;
  const std::uint64_t offsets_start = put_summary();
  put(out_, static_cast<std::uint8_t>(Opcode::kFooter));
  put(out_, kFooterContentBytes);
  put(out_, summary_start);
  put(out_, offsets_start);
  put(out_, crc32(out_));
  put_bytes(out_, std::as_bytes(std::span(kMagic)));
  if (Status written = emit(); !written.ok()) return written;
  status_ = sink_.flush();
  return status_;
}

}  // namespace stillhand::recording

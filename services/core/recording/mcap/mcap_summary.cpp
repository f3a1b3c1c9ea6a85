// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "services/core/recording/mcap/crc32.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/mcap_records.hpp"

namespace stillhand::recording {

struct McapReader::Summary {
  std::uint64_t start;
  std::optional<Statistics> statistics = {};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> metadata_places = {};  // offset, length
};

// True if the summary contains everything that reading needs.  Otherwise scan() reads the file;
// damage() has an entry if the summary is damaged, and none if the file has no summary.
bool McapReader::open_by_summary() {
  const std::uint64_t size = source_.size();
  std::optional<Footer> footer;
  if (size >= kFooterAndMagicBytes) {
    footer =
        parse_footer_and_magic(window_.view(size - kFooterAndMagicBytes, kFooterAndMagicBytes));
  }
  if (!footer) {
    add_damage(DamageKind::kNoFooter, size, 0,
               "no valid footer at the end: the recording was cut off, or its end is damaged");
    return false;
  }
  const std::uint64_t start = footer->summary_start;
  if (start == 0 && footer->summary_offset_start == 0) return false;
  const std::uint64_t footer_start = size - kFooterAndMagicBytes;
  // The checksum of the footer covers its fields before the checksum.
  const std::uint64_t checked_end = size - kMagic.size() - 4;
  const char* trouble = nullptr;
  if (start < kMagic.size() || start > footer_start) {
    trouble = "the footer points outside the file";
  } else if (checked_end - start > options_.max_chunk_bytes) {
    trouble = "the summary is larger than the reader may load";
  } else {
    const auto loaded = window_.view(start, checked_end - start);
    if (loaded.empty()) return false;  // the source failed
    std::vector<std::byte> summary(loaded.size());
    std::ranges::copy(loaded, summary.begin());
    const auto records = std::span(summary).first(static_cast<std::size_t>(footer_start - start));
    if (footer->summary_crc != 0 && crc32(summary) != footer->summary_crc) {
      trouble = "the checksum of the summary differs";
    } else if (!take_summary(records, start)) {
      trouble = "the summary contradicts itself or the size of the file";
    }
  }
  if (trouble != nullptr) {
    forget();
    add_damage(DamageKind::kBadSummary, start, 0, trouble);
    return false;
  }
  if (!indexed_) forget();
  return indexed_;
}

// False if a record contradicts itself; indexed_ states if the index is complete.
bool McapReader::take_summary(std::span<const std::byte> records, std::uint64_t summary_start) {
  Summary summary{summary_start};
  RecordView record{};
  while (!records.empty()) {
    if (!take_record(records, record) ||
        !take_summary_record(record.opcode, record.content, summary)) {
      return false;
    }
  }
  // Without statistics, or with counts that the summary does not reach, a scan is necessary.
  const auto& statistics = summary.statistics;
  indexed_ = statistics && statistics->chunk_count == pieces_.size() &&
             statistics->channel_count == channels_.size() &&
             statistics->metadata_count == summary.metadata_places.size() &&
             (statistics->message_count == 0 || !pieces_.empty());
  if (!indexed_) return true;
  statistics_ = *statistics;
  std::ranges::sort(pieces_, {}, &Piece::offset);
  for (const auto& [offset, length] : summary.metadata_places) {
    load_metadata(offset, length, summary_start);
  }
  find_data_end(summary_start);
  return true;
}

bool McapReader::take_summary_record(Opcode opcode, std::span<const std::byte> content,
                                     Summary& summary) {
  switch (opcode) {
    case Opcode::kSchema: {
      auto schema = parse_schema(content);
      if (schema) define(std::move(schema->record), summary.start);
      return schema.has_value();
    }
    case Opcode::kChannel: {
      auto channel = parse_channel(content);
      if (channel) define(std::move(channel->record), summary.start);
      return channel.has_value();
    }
    case Opcode::kStatistics:
      summary.statistics = parse_statistics(content);
      return summary.statistics.has_value();
    case Opcode::kChunkIndex: {
      const auto index = parse_chunk_index(content);
      return index && take_chunk_index(*index, summary.start);
    }
    case Opcode::kMetadataIndex: {
      WireReader in(content);
      const auto offset = in.take<std::uint64_t>();
      summary.metadata_places.emplace_back(offset, in.take<std::uint64_t>());
      return in.ok();
    }
    default:
      return true;
  }
}

void McapReader::find_data_end(std::uint64_t summary_start) {
  constexpr std::uint64_t kDataEndBytes = kRecordHeadBytes + 4;
  if (summary_start < kDataEndBytes) return;
  WireReader in(window_.view(summary_start - kDataEndBytes, kDataEndBytes));
  if (in.take<std::uint8_t>() == static_cast<std::uint8_t>(Opcode::kDataEnd) &&
      in.take<std::uint64_t>() == 4) {
    data_end_ = summary_start - kDataEndBytes;
  } else {
    add_damage(DamageKind::kBadRecord, summary_start - kDataEndBytes, 0,
               "no data end record before the summary");
  }
}

bool McapReader::take_chunk_index(const ChunkIndex& index, std::uint64_t summary_start) {
  if (index.offset > summary_start || index.length > summary_start - index.offset ||
      index.length < kRecordHeadBytes + kChunkFixedBytes) {
    return false;
  }
  pieces_.push_back({index.offset, index.length, true, index.start_time_ns, index.end_time_ns});
  return true;
}

void McapReader::load_metadata(std::uint64_t offset, std::uint64_t length, std::uint64_t end) {
  const bool fits = offset <= end && length <= end - offset && length <= options_.max_chunk_bytes;
  auto bytes = fits ? window_.view(offset, length) : std::span<const std::byte>{};
  RecordView record{};
  if (take_record(bytes, record) && record.opcode == Opcode::kMetadata) {
    if (auto metadata = parse_metadata(record.content)) {
      metadata_.push_back(std::move(metadata->record));
      return;
    }
  }
  add_damage(DamageKind::kBadRecord, offset, length,
             "the index states a metadata record here; it cannot be read");
}

// Restores the state before the attempt to read the summary.
void McapReader::forget() {
  indexed_ = false;
  schemas_.clear();
  channels_.clear();
  metadata_.clear();
  pieces_.clear();
  statistics_ = {};
  data_end_.reset();
}

}  // namespace stillhand::recording

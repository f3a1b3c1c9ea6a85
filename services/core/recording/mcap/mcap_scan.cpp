// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstring>

#include "services/core/recording/mcap/compression.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/core/recording/mcap/mcap_records.hpp"

namespace stillhand::recording {
namespace {

constexpr std::uint64_t kLastKnownOpcode = 0x0F;
// Largest size of the fields that a later version may append to a known record; a larger remainder
// counts as a false length.
constexpr std::uint64_t kMaxExtraBytes = 4096;

std::uint8_t value(Opcode opcode) { return static_cast<std::uint8_t>(opcode); }

// Smallest content of each kind of record, by opcode; kind 0 does not exist.
constexpr std::array<std::uint64_t, kLastKnownOpcode + 1> kLeastContentBytes = {
    0, 8, 20, 14, 16, kMessageHeadBytes, kChunkFixedBytes, 6, 64, 36, 48, 46, 8, 20, 17, 4};

// A chunk record at the front of `bytes`.  Test: its length equals the sum of its fields, which
// random bytes do not satisfy.
bool begins_chunk(std::span<const std::byte> bytes, std::uint64_t left_in_file) {
  WireReader in(bytes);
  if (in.take<std::uint8_t>() != value(Opcode::kChunk)) return false;
  const auto length = in.take<std::uint64_t>();
  if (!in.ok() || length > left_in_file - kRecordHeadBytes) return false;
  const auto head = parse_chunk_head(bytes.subspan(kRecordHeadBytes), length);
  return head && head->content_bytes() == length && compression_of(head->compression);
}

// True if its fields fill the content exactly.
bool is_sound_summary_record(Opcode opcode, std::span<const std::byte> content) {
  WireReader in(content);
  switch (opcode) {
    case Opcode::kChunkIndex:
      return parse_chunk_index(content).has_value();
    case Opcode::kStatistics:
      return parse_statistics(content).has_value();
    case Opcode::kSummaryOffset:
      return content.size() == 17;
    case Opcode::kMetadataIndex:
      (void)in.take_bytes(16);
      (void)in.take_text();
      return in.ok() && in.left() == 0;
    case Opcode::kAttachmentIndex:
      (void)in.take_bytes(40);
      (void)in.take_text();
      (void)in.take_text();
      return in.ok() && in.left() == 0;
    default:
      return false;
  }
}

}  // namespace

void McapReader::scan() {
  const std::uint64_t size = source_.size();
  const auto magic = window_.view(0, std::min<std::uint64_t>(size, kMagic.size()));
  const bool begins_well = std::ranges::equal(magic, std::as_bytes(std::span(kMagic)));
  std::uint64_t offset = begins_well ? kMagic.size() : next_chunk(0, size);
  while (offset < size && !data_end_ && window_.status().ok()) {
    offset = scan_record(offset);
  }
  count_messages();
}

// Reads the record at `offset` or adds the damage.  @returns the next offset; the size of the file
// at its end.
std::uint64_t McapReader::scan_record(std::uint64_t offset) {
  const std::uint64_t size = source_.size();
  const std::uint64_t left = size - offset;
  WireReader in(window_.view(offset, std::min(left, kRecordHeadBytes)));
  const auto opcode = static_cast<Opcode>(in.take<std::uint8_t>());
  const auto length = in.take<std::uint64_t>();
  const bool fits = in.ok() && length <= left - kRecordHeadBytes;
  if (opcode == Opcode::kFooter && fits &&
      parse_footer_and_magic(window_.view(offset, std::min(left, kFooterAndMagicBytes)))) {
    return size;
  }
  if (fits && scan_content(opcode, offset, length)) return offset + kRecordHeadBytes + length;
  const std::uint64_t next = next_chunk(offset + 1, size);
  if (!fits && next == size && value(opcode) <= kLastKnownOpcode && value(opcode) != 0) {
    add_damage(DamageKind::kCutOff, offset, left, "the last record is not complete");
  } else {
    add_damage(DamageKind::kBadRecord, offset, next - offset,
               "no readable record from here to the next chunk or the end of the file");
  }
  return next;
}

// True if the record is valid, as far as this is visible without a checksum.
bool McapReader::scan_content(Opcode opcode, std::uint64_t offset, std::uint64_t length) {
  const std::uint64_t begin = offset + kRecordHeadBytes;
  const std::uint64_t total = kRecordHeadBytes + length;
  switch (opcode) {
    case Opcode::kHeader:
      return offset == kMagic.size() && scan_header(length);
    case Opcode::kDataEnd:
      if (length == 4) data_end_ = offset;
      return length == 4;
    case Opcode::kChunk:
      return scan_chunk(offset, length);
    case Opcode::kMessageIndex: {
      WireReader in(window_.view(begin, std::min<std::uint64_t>(length, 6)));
      (void)in.take<std::uint16_t>();
      return in.take<std::uint32_t>() + std::uint64_t{6} == length && in.ok();
    }
    case Opcode::kSchema:
    case Opcode::kChannel:
    case Opcode::kMessage:
    case Opcode::kMetadata:
      if (length <= options_.max_chunk_bytes) return scan_bounded(opcode, offset, length);
      if (!may_follow(offset + total)) return false;
      add_damage(DamageKind::kTooLarge, offset, total, "record larger than the reader may load");
      return true;
    case Opcode::kAttachment:
      if (!may_follow(offset + total)) return false;
      ++statistics_.attachment_count;
      return true;
    default:
      if (value(opcode) <= kLastKnownOpcode) {  // a record of the summary: the data end is lost
        return length <= options_.max_chunk_bytes &&
               is_sound_summary_record(opcode, window_.view(begin, length));
      }
      if (!may_follow(offset + total)) return false;
      add_damage(DamageKind::kUnknownRecord, offset, total,
                 "a record of an unknown kind was skipped");
      return true;
  }
}

bool McapReader::scan_header(std::uint64_t length) {
  if (length > options_.max_chunk_bytes) return false;
  WireReader in(window_.view(kMagic.size() + kRecordHeadBytes, length));
  (void)in.take_text();
  (void)in.take_text();
  return in.ok() && proves_length(kMagic.size(), length, in.left());
}

// Records that are loaded completely: definitions and messages outside chunks, and metadata.
bool McapReader::scan_bounded(Opcode opcode, std::uint64_t offset, std::uint64_t length) {
  const std::uint64_t total = kRecordHeadBytes + length;
  const auto content = window_.view(offset + kRecordHeadBytes, length);
  std::optional<std::uint64_t> extra_bytes;
  std::optional<Parsed<Metadata>> metadata;
  if (opcode == Opcode::kSchema) {
    if (const auto schema = parse_schema(content)) extra_bytes = schema->extra_bytes;
  } else if (opcode == Opcode::kChannel) {
    if (const auto channel = parse_channel(content)) extra_bytes = channel->extra_bytes;
  } else if (opcode == Opcode::kMetadata) {
    metadata = parse_metadata(content);
    if (metadata) extra_bytes = metadata->extra_bytes;
  } else if (length >= kMessageHeadBytes) {
    extra_bytes = 0;
  }
  if (!extra_bytes || !proves_length(offset, length, *extra_bytes)) return false;
  if (opcode == Opcode::kMessage) {
    // The length is free, so the only test is the following record.  After a chunk, this is more
    // likely another record with a changed opcode, because no file mixes the two forms.
    const bool chunk_seen = std::ranges::any_of(pieces_, &Piece::is_chunk);
    if (chunk_seen || !may_follow(offset + total)) return false;
  }
  if (metadata) {
    metadata_.push_back(std::move(metadata->record));
  } else if (!pieces_.empty() && !pieces_.back().is_chunk &&
             pieces_.back().offset + pieces_.back().length == offset) {
    pieces_.back().length += total;
  } else {
    pieces_.push_back({offset, total, false, 0, UINT64_MAX});
  }
  return true;
}

bool McapReader::scan_chunk(std::uint64_t offset, std::uint64_t length) {
  const auto head = parse_chunk_head(
      window_.view(offset + kRecordHeadBytes, std::min(length, kChunkHeadBytes)), length);
  if (!head) return false;
  const std::uint64_t extra = length - head->content_bytes();
  const std::uint64_t total = kRecordHeadBytes + length;
  if (!proves_length(offset, length, extra)) return false;
  pieces_.push_back({offset, total, true, 0, UINT64_MAX});
  return true;
}

// Fields that fill the content prove its length.  Additional bytes count as fields of a later
// version if they are few, contain no chunk, and a record follows them.
bool McapReader::proves_length(std::uint64_t offset, std::uint64_t length,
                               std::uint64_t extra_bytes) {
  if (extra_bytes == 0) return true;
  const std::uint64_t end = offset + kRecordHeadBytes + length;
  return extra_bytes <= kMaxExtraBytes && may_follow(end) &&
         next_chunk(end - extra_bytes, end) >= end;
}

// True at places that a false length hardly reaches: the end of the file, or the head of a record
// with a plausible length.  A record cut off by the end of the file also counts, so the record
// before it is not lost.
bool McapReader::may_follow(std::uint64_t offset) {
  const std::uint64_t size = source_.size();
  if (offset == size) return true;
  const std::uint64_t left = size - offset;
  WireReader in(window_.view(offset, std::min(left, kRecordHeadBytes)));
  const auto opcode = in.take<std::uint8_t>();
  if (opcode == 0) return false;
  if (left < kRecordHeadBytes) return opcode <= kLastKnownOpcode;
  const auto length = in.take<std::uint64_t>();
  const bool fits = length <= left - kRecordHeadBytes;
  if (opcode > kLastKnownOpcode) return fits;
  return length >= kLeastContentBytes[opcode] && (fits || length <= options_.max_chunk_bytes);
}

// First offset in [offset, end) at which a chunk begins, or the size of the file.
std::uint64_t McapReader::next_chunk(std::uint64_t offset, std::uint64_t end) {
  constexpr std::uint64_t kBlockBytes = 65'536;
  constexpr std::uint64_t kLookBytes = kRecordHeadBytes + kChunkHeadBytes;
  const std::uint64_t size = source_.size();
  while (offset < end) {
    const auto block = window_.view(offset, std::min(kBlockBytes, size - offset));
    if (block.empty()) break;
    const bool last = offset + block.size() == size;
    const std::size_t stop = last ? block.size() : block.size() - kLookBytes;
    std::size_t i = 0;
    while (i < stop) {
      const void* hit = std::memchr(block.data() + i, value(Opcode::kChunk), stop - i);
      if (hit == nullptr) break;
      i = static_cast<std::size_t>(static_cast<const std::byte*>(hit) - block.data());
      const std::uint64_t left = size - offset - i;
      if (left > kRecordHeadBytes && begins_chunk(block.subspan(i), left)) return offset + i;
      ++i;
    }
    offset += stop;
  }
  return size;
}

}  // namespace stillhand::recording

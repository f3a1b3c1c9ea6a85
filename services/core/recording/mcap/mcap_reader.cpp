// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/mcap_reader.hpp"

#include <algorithm>

#include "services/core/recording/mcap/crc32.hpp"
#include "services/core/recording/mcap/mcap_records.hpp"

namespace stillhand::recording {

McapReader::McapReader(ByteSource& source, McapReaderOptions options)
    : source_(source), options_(options), window_(source) {
  if (is_newer()) return;
  const bool sound_header = read_header();
  if (open_by_summary()) {
    if (!sound_header) {
      add_damage(DamageKind::kBadRecord, kMagic.size(), 0,
                 "the header cannot be read: profile and program are unknown");
    }
  } else if (window_.status().ok()) {
    scan();
  }
  if (status_.ok()) status_ = window_.status();
  if (status_.ok()) straighten_clock();
  if (!status_.ok()) {
    forget();
  } else if (pieces_.empty() && !damage_.empty() && damage_.front().kind == DamageKind::kNoMagic) {
    status_ = Status::failure(
        StatusKind::kDamaged,
        version_at(0) ? "an MCAP file of version " + std::string(1, *version_at(0))
                      : "not an MCAP file: neither its first bytes nor any chunk in it is one");
  }
}

// The version in the magic at `offset`, if it is a magic; its byte is a digit.
std::optional<char> McapReader::version_at(std::uint64_t offset) {
  constexpr std::size_t kVersionByte = 5;
  const auto magic = window_.view(offset, kMagic.size());
  if (magic.size() < kMagic.size()) return std::nullopt;
  for (std::size_t i = 0; i < kMagic.size(); ++i) {
    if (i != kVersionByte && magic[i] != std::byte{kMagic[i]}) return std::nullopt;
  }
  const char version = static_cast<char>(magic[kVersionByte]);
  return version >= '0' && version <= '9' ? std::optional(version) : std::nullopt;
}

// Both ends must state it: at only one end, it can be a changed byte.
bool McapReader::is_newer() {
  const std::uint64_t size = source_.size();
  if (size < 2 * kMagic.size()) return false;
  const auto first = version_at(0);
  const auto last = version_at(size - kMagic.size());
  if (!first || first != last || *first == '0') return false;
  status_ =
      Status::failure(StatusKind::kDamaged, "an MCAP file of version " + std::string(1, *first));
  return true;
}

// False if the header is missing; also reports a file with a wrong first magic.
bool McapReader::read_header() {
  const auto magic = window_.view(0, kMagic.size());
  if (!std::ranges::equal(magic, std::as_bytes(std::span(kMagic)))) {
    add_damage(DamageKind::kNoMagic, 0, 0, "the file does not begin like an MCAP file");
    return true;
  }
  const std::uint64_t left = source_.size() - kMagic.size();
  WireReader head(window_.view(kMagic.size(), std::min(left, kRecordHeadBytes)));
  const auto opcode = static_cast<Opcode>(head.take<std::uint8_t>());
  const auto length = head.take<std::uint64_t>();
  if (!head.ok() || opcode != Opcode::kHeader || length > left - kRecordHeadBytes ||
      !scan_header(length)) {
    return false;
  }
  WireReader in(window_.view(kMagic.size() + kRecordHeadBytes, length));
  profile_ = in.take_text();
  library_ = in.take_text();
  return true;
}

void McapReader::add_damage(DamageKind kind, std::uint64_t offset, std::uint64_t lost_bytes,
                            std::string text) {
  const bool known = std::ranges::any_of(damage_, [&](const Damage& damage) {
    return damage.kind == kind && damage.offset == offset;
  });
  if (!known) damage_.push_back({kind, offset, lost_bytes, std::move(text)});
}

void McapReader::define(Schema schema, std::uint64_t offset) {
  if (schema.id == 0) return;
  const auto [place, added] = schemas_.try_emplace(schema.id, schema);
  if (!added && place->second != schema) {
    add_damage(DamageKind::kBadRecord, offset, 0,
               "schema " + std::to_string(schema.id) + " is defined twice; the first one is used");
  }
}

void McapReader::define(Channel channel, std::uint64_t offset) {
  const auto [place, added] = channels_.try_emplace(channel.id, channel);
  if (!added && place->second != channel) {
    add_damage(
        DamageKind::kBadRecord, offset, 0,
        "channel " + std::to_string(channel.id) + " is defined twice; the first one is used");
  }
}

Status McapReader::verify(const std::function<void(const MessageView&)>& take) {
  if (!status_.ok()) return status_;
  Status walked = for_each_message({}, [&take](const MessageView& message) {
    if (take) take(message);
    return true;
  });
  if (!walked.ok() || !data_end_) return walked;
  constexpr std::uint64_t kBlockBytes = 1 << 20;
  std::uint32_t crc = 0;
  for (std::uint64_t offset = 0; offset < *data_end_;) {
    packed_.resize(static_cast<std::size_t>(std::min(kBlockBytes, *data_end_ - offset)));
    status_ = source_.read_at(offset, packed_);
    if (!status_.ok()) return status_;
    crc = crc32(packed_, crc);
    offset += packed_.size();
  }
  WireReader in(window_.view(*data_end_ + kRecordHeadBytes, 4));
  const auto stored = in.take<std::uint32_t>();
  if (stored != 0 && stored != crc) {
    add_damage(DamageKind::kBadDataSection, 0, 0,
               "the checksum of the data section differs: at least one byte has changed");
  }
  return window_.status();
}

const Metadata* McapReader::find_metadata(std::string_view name) const noexcept {
  const auto found = std::ranges::find(metadata_, name, &Metadata::name);
  return found == metadata_.end() ? nullptr : &*found;
}

std::uint64_t McapReader::lost_bytes() const noexcept { return recording::lost_bytes(damage_); }

}  // namespace stillhand::recording

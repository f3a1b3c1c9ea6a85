// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/wire.hpp"

namespace stillhand::recording {

void put_bytes(Bytes& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

void put_text(Bytes& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  put_bytes(out, std::as_bytes(std::span(text)));
}

void put_map(Bytes& out, const TextMap& texts) {
  std::uint32_t length = 0;
  for (const auto& [key, value] : texts) {
    length += static_cast<std::uint32_t>(8 + key.size() + value.size());
  }
  put(out, length);
  for (const auto& [key, value] : texts) {
    put_text(out, key);
    put_text(out, value);
  }
}

std::size_t begin_record(Bytes& out, Opcode opcode) {
  put(out, static_cast<std::uint8_t>(opcode));
  const std::size_t mark = out.size();
  put(out, std::uint64_t{0});
  return mark;
}

void end_record(Bytes& out, std::size_t mark) {
  const std::uint64_t length = out.size() - mark - 8;
  for (std::size_t i = 0; i < 8; ++i) out[mark + i] = static_cast<std::byte>(length >> (8 * i));
}

std::span<const std::byte> WireReader::take_bytes(std::uint64_t count) noexcept {
  if (!ok_ || count > bytes_.size()) {
    ok_ = false;
    bytes_ = {};
    return {};
  }
  const auto taken = bytes_.first(static_cast<std::size_t>(count));
  bytes_ = bytes_.subspan(taken.size());
  return taken;
}

std::string WireReader::take_text() {
  const auto raw = take_bytes(take<std::uint32_t>());
  return {reinterpret_cast<const char*>(raw.data()), raw.size()};
}

TextMap WireReader::take_map() {
  TextMap texts;
  WireReader entries(take_bytes(take<std::uint32_t>()));
  while (entries.left() > 0) {
    std::string key = entries.take_text();
    std::string value = entries.take_text();
    if (!entries.ok()) {
      ok_ = false;
      break;
    }
    texts.insert_or_assign(std::move(key), std::move(value));
  }
  return texts;
}

bool take_record(std::span<const std::byte>& records, RecordView& record) noexcept {
  WireReader head(records);
  record.opcode = static_cast<Opcode>(head.take<std::uint8_t>());
  record.content = head.take_bytes(head.take<std::uint64_t>());
  if (!head.ok()) return false;
  records = records.subspan(kRecordHeadBytes + record.content.size());
  return true;
}

}  // namespace stillhand::recording

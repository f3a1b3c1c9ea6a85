// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <concepts>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/recording/mcap/mcap_format.hpp"

namespace stillhand::recording {

using Bytes = std::vector<std::byte>;

// Encoding: little-endian integers; a 32-bit length precedes each text.
template <std::unsigned_integral T>
void put(Bytes& out, T value) {
  std::byte raw[sizeof(T)];
  for (std::size_t i = 0; i < sizeof(T); ++i) {
    raw[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  out.insert(out.end(), raw, raw + sizeof(T));
}
void put_bytes(Bytes& out, std::span<const std::byte> bytes);
void put_text(Bytes& out, std::string_view text);
void put_map(Bytes& out, const TextMap& texts);
/// Writes the opcode and a placeholder for the length.  @returns the mark for end_record().
std::size_t begin_record(Bytes& out, Opcode opcode);
void end_record(Bytes& out, std::size_t mark);

/// Decodes from a span and never reads outside it: after the first field that does not fit, ok() is
/// false and every field is zero or empty.
class WireReader {
 public:
  explicit WireReader(std::span<const std::byte> bytes) noexcept : bytes_(bytes) {}

  template <std::unsigned_integral T>
  T take() noexcept {
    const auto raw = take_bytes(sizeof(T));
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      value |= std::to_integer<std::uint64_t>(raw[i]) << (8 * i);
    }
    return static_cast<T>(value);
  }
  std::span<const std::byte> take_bytes(std::uint64_t count) noexcept;
  std::string take_text();
  TextMap take_map();

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
  bool ok_ = true;
};

/// A record inside a span.
struct RecordView {
  Opcode opcode;
  std::span<const std::byte> content;
};

/// Removes the next record from the front of `records`; false if the rest is not a whole record.
bool take_record(std::span<const std::byte>& records, RecordView& record) noexcept;

}  // namespace stillhand::recording

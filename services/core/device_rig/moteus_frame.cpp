// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_frame.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace stillhand::device_rig::moteus {
namespace {

constexpr std::uint32_t kWrite = 0x00;
constexpr std::uint32_t kRead = 0x10;
constexpr std::uint32_t kReply = 0x20;
constexpr std::uint32_t kWriteError = 0x30;
constexpr std::uint32_t kReadError = 0x31;
constexpr std::uint32_t kToConsole = 0x40;
constexpr std::uint32_t kFromConsole = 0x41;
constexpr std::uint32_t kPollConsole = 0x42;
constexpr std::uint32_t kNop = 0x50;
constexpr std::uint32_t kConsoleChannel = 1;

std::uint32_t size_of(Resolution resolution) noexcept {
  switch (resolution) {
    case Resolution::kInt8:
      return 1;
    case Resolution::kInt16:
      return 2;
    default:
      return 4;
  }
}

/// Little-endian bits as a signed integer.
std::int64_t as_signed(std::uint32_t bits, std::uint32_t size) noexcept {
  const std::uint32_t unused = 32 - 8 * size;
  return static_cast<std::int32_t>(bits << unused) >> unused;
}

std::uint32_t encoded(double value, double step, std::uint32_t size) noexcept {
  const double most = std::ldexp(1.0, static_cast<int>(8 * size) - 1) - 1.0;
  if (!std::isfinite(value))
    return static_cast<std::uint32_t>(static_cast<std::int64_t>(-most - 1));
  const double count = std::clamp(std::round(value / step), -most, most);
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(count));
}

}  // namespace

void FrameWriter::byte(std::uint32_t value) noexcept {
  if (frame_.size >= Frame::kMost) {
    good_ = false;
    return;
  }
  frame_.bytes[frame_.size++] = static_cast<std::uint8_t>(value & 0xffu);
}

void FrameWriter::varuint(std::uint32_t value) noexcept {
  while (value > 0x7fu) {
    byte((value & 0x7fu) | 0x80u);
    value >>= 7;
  }
  byte(value);
}

void FrameWriter::head(std::uint32_t type, Resolution resolution, Register first,
                       std::uint32_t count) noexcept {
  const std::uint32_t kind = type | (static_cast<std::uint32_t>(resolution) << 2);
  if (count <= 3) {
    byte(kind | count);
  } else {
    byte(kind);
    varuint(count);
  }
  varuint(first);
}

void FrameWriter::value(Resolution resolution, std::uint32_t address, double value) noexcept {
  const std::uint32_t size = size_of(resolution);
  const std::uint32_t bits = resolution == Resolution::kFloat
                                 ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                                 : encoded(value, step_of(address, resolution), size);
  for (std::uint32_t i = 0; i < size; ++i) byte(bits >> (8 * i));
}

void FrameWriter::write(Resolution resolution, Register first,
                        std::initializer_list<double> values) noexcept {
  head(kWrite, resolution, first, static_cast<std::uint32_t>(values.size()));
  std::uint32_t address = first;
  for (const double each : values) value(resolution, address++, each);
}

void FrameWriter::read(Resolution resolution, Register first, std::uint32_t count) noexcept {
  head(kRead, resolution, first, count);
}

void FrameWriter::to_console(std::string_view text) noexcept {
  byte(kToConsole);
  varuint(kConsoleChannel);
  varuint(static_cast<std::uint32_t>(text.size()));
  for (const char c : text) byte(static_cast<unsigned char>(c));
}

void FrameWriter::poll_console(std::uint32_t most) noexcept {
  byte(kPollConsole);
  varuint(kConsoleChannel);
  varuint(most);
}

void FrameWriter::pad() noexcept {
  constexpr std::array<std::size_t, 8> kLengths{8, 12, 16, 20, 24, 32, 48, 64};
  if (frame_.size <= kLengths.front()) return;
  const auto length = std::ranges::lower_bound(kLengths, frame_.size);
  while (length != kLengths.end() && frame_.size < *length) byte(kNop);
}

std::optional<std::uint32_t> FrameReader::byte() noexcept {
  if (rest_.empty()) return std::nullopt;
  const std::uint32_t first = rest_.front();
  rest_ = rest_.subspan(1);
  return first;
}

std::optional<std::uint32_t> FrameReader::varuint() noexcept {
  std::uint32_t value = 0;
  for (std::uint32_t shift = 0; shift < 35; shift += 7) {
    const auto next = byte();
    if (!next) return std::nullopt;
    value |= (*next & 0x7fu) << shift;
    if ((*next & 0x80u) == 0) return value;
  }
  return std::nullopt;
}

std::optional<FrameReader::Item> FrameReader::fail() noexcept {
  sound_ = false;
  rest_ = {};
  return std::nullopt;
}

std::optional<FrameReader::Item> FrameReader::next() noexcept {
  while (true) {
    if (left_ > 0) return value();
    const auto type = byte();
    if (!type) return std::nullopt;
    if (*type == kNop) continue;
    if (auto item = begin(*type)) return item;
    if (left_ == 0) return std::nullopt;
  }
}

// A reply only prepares its values and returns nothing; so does what is not understood.
std::optional<FrameReader::Item> FrameReader::begin(std::uint32_t type) noexcept {
  if (type == kWriteError || type == kReadError) {
    const auto address = varuint();
    const auto error = varuint();
    if (!address || !error) return fail();
    return Item{.kind = type == kWriteError ? Kind::kWriteError : Kind::kReadError,
                .address = *address,
                .error = *error};
  }
  if (type == kFromConsole) {
    const auto channel = varuint();
    const auto size = varuint();
    if (!channel || !size || *size > rest_.size()) return fail();
    const auto text = rest_.first(*size);
    rest_ = rest_.subspan(*size);
    return Item{.kind = Kind::kConsole, .console = text};
  }
  if ((type & 0xf0u) != kReply) return fail();
  const auto count = (type & 3u) != 0 ? std::optional(type & 3u) : varuint();
  const auto first = varuint();
  if (!count || !first || *count == 0) return fail();
  resolution_ = static_cast<Resolution>((type >> 2) & 3u);
  left_ = *count;
  address_ = *first;
  return std::nullopt;
}

std::optional<FrameReader::Item> FrameReader::value() noexcept {
  const std::uint32_t size = size_of(resolution_);
  if (rest_.size() < size) return fail();
  std::uint32_t bits = 0;
  for (std::uint32_t i = 0; i < size; ++i) bits |= std::uint32_t{rest_[i]} << (8 * i);
  rest_ = rest_.subspan(size);
  --left_;
  Item item{.kind = Kind::kValue, .address = address_};
  if (resolution_ == Resolution::kFloat) {
    item.value = std::bit_cast<float>(bits);
  } else {
    const std::int64_t count = as_signed(bits, size);
    const bool none = has_nan(address_) && count == -(std::int64_t{1} << (8 * size - 1));
    item.value = none ? std::numeric_limits<double>::quiet_NaN()
                      : static_cast<double>(count) * step_of(address_, resolution_);
  }
  ++address_;
  return item;
}

}  // namespace stillhand::device_rig::moteus

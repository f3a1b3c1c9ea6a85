// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/fdcanusb_line.hpp"

#include <charconv>
#include <optional>

namespace stillhand::device_rig::moteus {
namespace {

constexpr std::string_view kDigits = "0123456789abcdef";
constexpr std::uint8_t kPolynomial = 0x97;

std::optional<std::uint32_t> number(std::string_view text) noexcept {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole && text.size() <= 8 ? std::optional(value) : std::nullopt;
}

/// Takes the first word off a line.
std::string_view word(std::string_view& line) noexcept {
  while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
  const std::size_t end = std::min(line.find(' '), line.size());
  const std::string_view first = line.substr(0, end);
  line.remove_prefix(end);
  return first;
}

class LineWriter {
 public:
  explicit LineWriter(Line& line) noexcept : line_(line) {}
  void put(char c) noexcept {
    if (line_.size < line_.text.size()) line_.text[line_.size++] = c;
  }
  void put(std::string_view text) noexcept {
    for (const char c : text) put(c);
  }
  void put_byte(std::uint32_t value) noexcept {
    put(kDigits[(value >> 4) & 15u]);
    put(kDigits[value & 15u]);
  }

 private:
  Line& line_;
};

bool read_payload(std::string_view digits, Frame& frame) noexcept {
  if (digits.size() % 2 != 0 || digits.size() / 2 > Frame::kMost) return false;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    const auto each = number(digits.substr(i, 2));
    if (!each) return false;
    frame.bytes[frame.size++] = static_cast<std::uint8_t>(*each);
  }
  return true;
}

/// Takes " *XX" off.  False: wrong, or missing where it is required.
bool take_checksum(std::string_view& line, bool required) noexcept {
  const std::size_t star = line.rfind('*');
  if (star == std::string_view::npos) return !required;
  const auto claimed = number(line.substr(star + 1));
  if (!claimed || line.size() != star + 3 || *claimed != checksum_of(line.substr(0, star))) {
    return false;
  }
  line = line.substr(0, star);
  return true;
}

}  // namespace

std::uint8_t checksum_of(std::string_view text) noexcept {
  std::uint32_t crc = 0;
  for (const char c : text) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 0x80u) != 0 ? (crc << 1 ^ kPolynomial) & 0xffu : crc << 1;
    }
  }
  return static_cast<std::uint8_t>(crc);
}

Line send_line(std::uint32_t identifier, const Frame& frame, bool checked) noexcept {
  Line line;
  LineWriter writer(line);
  writer.put("can send ");
  writer.put_byte(identifier >> 8);
  writer.put_byte(identifier);
  writer.put(' ');
  for (const std::uint8_t each : frame.payload()) writer.put_byte(each);
  if (checked) {
    writer.put(' ');
    const std::uint8_t crc = checksum_of(line.view());
    writer.put('*');
    writer.put_byte(crc);
  }
  writer.put('\n');
  return line;
}

Received read_line(std::string_view line, bool checked) noexcept {
  Received received;
  if (!take_checksum(line, checked)) {
    received.kind = Received::Kind::kDamaged;
    return received;
  }
  const std::string_view first = word(line);
  if (first == "OK") received.kind = Received::Kind::kOk;
  if (first == "ERR") received.kind = Received::Kind::kError;
  if (first != "rcv") return received;
  const auto identifier = number(word(line));
  if (!identifier || !read_payload(word(line), received.frame)) {
    received.kind = Received::Kind::kDamaged;
    return received;
  }
  received.kind = Received::Kind::kFrame;
  received.identifier = *identifier;
  return received;
}

}  // namespace stillhand::device_rig::moteus

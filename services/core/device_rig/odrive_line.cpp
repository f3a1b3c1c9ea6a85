// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/odrive_line.hpp"

#include <charconv>

namespace stillhand::device_rig::odrive {

std::uint8_t checksum_of(std::string_view text) noexcept {
  std::uint32_t sum = 0;
  for (const char c : text) sum ^= static_cast<unsigned char>(c);
  return static_cast<std::uint8_t>(sum);
}

void Lines::put(std::string_view text) noexcept {
  if (text.size() > text_.size() - size_) {
    good_ = false;
    return;
  }
  for (const char c : text) text_[size_++] = c;
}

// A line that does not fit as a whole is not begun.
void Lines::end(std::size_t begin) noexcept {
  put(" ");
  std::array<char, 4> digits{};
  const std::uint8_t sum = checksum_of({text_.data() + begin, size_ - begin});
  const auto [last, error] = std::to_chars(digits.data(), digits.data() + digits.size(), sum);
  put("*");
  put({digits.data(), static_cast<std::size_t>(last - digits.data())});
  put("\n");
  if (!good_) size_ = begin;
}

void Lines::add(std::string_view command) noexcept {
  const std::size_t begin = size_;
  put(command);
  end(begin);
}

void Lines::add(std::string_view command, std::uint64_t value) noexcept {
  const std::size_t begin = size_;
  std::array<char, 24> digits{};
  const auto [last, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  put(command);
  put({digits.data(), static_cast<std::size_t>(last - digits.data())});
  end(begin);
}

void Lines::add(std::string_view command, double value) noexcept {
  constexpr int kDecimals = 6;
  const std::size_t begin = size_;
  std::array<char, 32> digits{};
  const auto [last, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value,
                                           std::chars_format::fixed, kDecimals);
  if (error != std::errc()) good_ = false;
  put(command);
  put({digits.data(), static_cast<std::size_t>(last - digits.data())});
  end(begin);
}

std::optional<std::string_view> read_line(std::string_view line) noexcept {
  const std::size_t star = line.rfind('*');
  if (star == std::string_view::npos) return std::nullopt;
  const auto claimed = whole_of(line.substr(star + 1));
  const std::string_view text = line.substr(0, star);
  if (!claimed || *claimed != checksum_of(text)) return std::nullopt;
  return text;
}

std::optional<std::uint64_t> whole_of(std::string_view text) noexcept {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end) return std::nullopt;
  return value;
}

std::optional<double> real_of(std::string_view text) noexcept {
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || last != end) return std::nullopt;
  return value;
}

}  // namespace stillhand::device_rig::odrive

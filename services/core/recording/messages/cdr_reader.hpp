// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace stillhand::recording {

/// Reads values from a CDR message: 4 bytes of encapsulation, then values aligned to their size,
/// counted from the end of the encapsulation (OMG DDS-XTypes 1.3, 7.4).  Plain CDR and plain XCDR2,
/// either byte order.  It never reads outside the message: after the first value that does not fit,
/// ok() is false and every value is zero.
class CdrReader {
 public:
  explicit CdrReader(std::span<const std::byte> message) noexcept : bytes_(message) {
    if (message.size() < kEncapsulationBytes) {
      ok_ = false;
      return;
    }
    const auto kind = static_cast<std::uint8_t>(message[1]);
    const bool plain = message[0] == std::byte{0} && (kind <= 1 || kind == 6 || kind == 7);
    if (!plain) ok_ = false;
    little_ = (kind & 1) != 0;
    second_edition_ = kind >= 6;
    at_ = kEncapsulationBytes;
  }

  /// True for XCDR2: 64-bit values are aligned to 4, and lists of structs have a head.
  [[nodiscard]] bool second_edition() const noexcept { return second_edition_; }
  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] std::size_t left() const noexcept { return ok_ ? bytes_.size() - at_ : 0; }

  template <typename T>
  T take() noexcept {
    const std::size_t most = second_edition_ ? 4 : 8;
    const std::size_t unit = std::min(sizeof(T), most);
    const std::size_t past = (at_ - kEncapsulationBytes) % unit;
    const std::size_t begin = past == 0 ? at_ : at_ + unit - past;
    if (!ok_ || begin > bytes_.size() || sizeof(T) > bytes_.size() - begin) {
      ok_ = false;
      return T{};
    }
    std::byte raw[sizeof(T)];
    std::memcpy(raw, bytes_.data() + begin, sizeof(T));
    if (little_ != (std::endian::native == std::endian::little)) std::ranges::reverse(raw);
    at_ = begin + sizeof(T);
    T value;
    std::memcpy(&value, raw, sizeof(T));
    return value;
  }

  /// A text without its final zero; valid as long as the message.
  std::string_view take_text() noexcept {
    const auto length = take<std::uint32_t>();
    if (!ok_ || length > bytes_.size() - at_) {
      ok_ = false;
      return {};
    }
    const std::string_view text(reinterpret_cast<const char*>(bytes_.data()) + at_, length);
    at_ += length;
    return text.ends_with('\0') ? text.substr(0, length - 1) : text;
  }

 private:
  static constexpr std::size_t kEncapsulationBytes = 4;

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
  bool little_ = true;
  bool second_edition_ = false;
};

}  // namespace stillhand::recording

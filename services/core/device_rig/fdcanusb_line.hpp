// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "services/core/device_rig/moteus_frame.hpp"

namespace stillhand::device_rig::moteus {

/// CRC-8 of polynomial 0x97, from 0.  Source: mjbots/moteus, docs/integration/uart.md.
std::uint8_t checksum_of(std::string_view text) noexcept;

/// A line to the adapter, its newline included.
struct Line {
  std::array<char, 192> text{};
  std::size_t size = 0;

  [[nodiscard]] std::string_view view() const noexcept { return {text.data(), size}; }
};

/// "can send <ID> <payload>", METHOD Eq. DR-2.
/// @param identifier  source << 8 | destination; 0x8000 asks for a reply
/// @param checked     with " *XX": the CRC of everything before the star
Line send_line(std::uint32_t identifier, const Frame& frame, bool checked) noexcept;

/// One line of the adapter.
struct Received {
  enum class Kind : std::uint8_t {
    kOk,       ///< the last command was taken
    kError,    ///< it was refused
    kFrame,    ///< a frame of the bus
    kDamaged,  ///< a wrong checksum, or none where one is required, or digits that are none
    kOther
  };
  Kind kind = Kind::kOther;
  std::uint32_t identifier = 0;
  Frame frame;  ///< of kFrame
};

/// @param checked  a checksum is required
Received read_line(std::string_view line, bool checked) noexcept;

/// Bytes of a serial port to lines, without allocation.  A line that is too long is dropped up to
/// its end.
class LineSplitter {
 public:
  /// Calls `on_line(std::string_view)` for each line that the bytes complete.
  template <typename OnLine>
  void take(std::string_view bytes, OnLine&& on_line) noexcept {
    for (const char c : bytes) {
      if (c == '\n' || c == '\r') {
        if (!overrun_ && size_ > 0) on_line(std::string_view(line_.data(), size_));
        overrun_ = false;
        size_ = 0;
      } else if (size_ < line_.size()) {
        line_[size_++] = c;
      } else {
        overrun_ = true;
      }
    }
  }

 private:
  std::array<char, 256> line_{};
  std::size_t size_ = 0;
  bool overrun_ = false;
};

}  // namespace stillhand::device_rig::moteus

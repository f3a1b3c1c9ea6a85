// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace stillhand::device_rig {

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

}  // namespace stillhand::device_rig

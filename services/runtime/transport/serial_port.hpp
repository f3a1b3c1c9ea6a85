// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace stillhand::runtime {

/// A serial port or pseudo-terminal, raw and non-blocking, for this process alone.  One thread.
class SerialPort {
 public:
  /// @throws ConfigError if the port is missing, is no terminal, cannot be opened, or another
  ///         process has it
  explicit SerialPort(const std::string& path);
  ~SerialPort();
  SerialPort(const SerialPort&) = delete;
  SerialPort& operator=(const SerialPort&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  /// Bytes that are there; empty if none.  gone() reports a port that was pulled out.
  std::string_view read(std::span<char> into) noexcept;
  /// All or a part, never waiting.  @returns false if not all of it was taken: the other side then
  /// has a piece, which the caller ends with a newline before the next line
  bool write(std::string_view text) noexcept;
  [[nodiscard]] bool gone() const noexcept { return gone_; }

 private:
  int descriptor_ = -1;
  bool gone_ = false;
};

}  // namespace stillhand::runtime

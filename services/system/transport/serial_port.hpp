// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "services/system/transport/port.hpp"

namespace stillhand::runtime {

/// A serial port or pseudo-terminal, raw and non-blocking, for this process alone.  One thread.
class SerialPort final : public Port {
 public:
  /// @throws ConfigError if the port is missing, is no terminal, cannot be opened, or another
  ///         process has it
  explicit SerialPort(const std::string& path);
  ~SerialPort() override;

  [[nodiscard]] int descriptor() const noexcept override { return descriptor_; }
  std::string_view read(std::span<char> into) noexcept override;
  /// If not all of it was taken, the other side has a piece, which the caller ends with a newline
  /// before the next line.
  bool write(std::string_view text) noexcept override;
  [[nodiscard]] bool gone() const noexcept override { return gone_; }

 private:
  int descriptor_ = -1;
  bool gone_ = false;
};

}  // namespace stillhand::runtime

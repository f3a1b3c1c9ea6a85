// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace stillhand::runtime {

/// Bytes to and from a device, non-blocking, for this process alone.  One thread.
class Port {
 public:
  virtual ~Port() = default;
  Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;

  [[nodiscard]] virtual int descriptor() const noexcept = 0;
  /// Bytes that are there; empty if none.  gone() reports a device that was pulled out.
  virtual std::string_view read(std::span<char> into) noexcept = 0;
  /// All or a part, never waiting.  @returns false if not all of it was taken
  virtual bool write(std::string_view bytes) noexcept = 0;
  [[nodiscard]] virtual bool gone() const noexcept = 0;
};

}  // namespace stillhand::runtime

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "services/core/recording/mcap/status.hpp"

namespace stillhand::recording {

/// Target of a recording: bytes are appended, never changed.  recording/file_io.hpp has the sink on
/// a file, tests/support/memory_bytes.hpp the sink in memory.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  /// Appends all bytes or fails; after a failure, a part of them may be appended.
  virtual Status write(std::span<const std::byte> bytes) = 0;
  /// After it, the written bytes survive a power failure.  May block for long.
  virtual Status flush() = 0;
  /// Bytes appended so far.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
};

/// Source of a recording: random access to a fixed number of bytes.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `into` from `offset`; fails if the range is not inside size().
  virtual Status read_at(std::uint64_t offset, std::span<std::byte> into) = 0;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
};

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "services/recording/core/status.hpp"

namespace stillhand::recording {

/// Where a recording goes: bytes are appended, never changed.  Files are in recording/file_io.hpp,
/// memory in memory_bytes.hpp.
class ByteSink {
 public:
  virtual ~ByteSink() = default;
  /// Appends all bytes, or fails; after a failure part of them may have been appended.
  virtual Status write(std::span<const std::byte> bytes) = 0;
  /// Makes what was written survive a loss of power.  May block for long.
  virtual Status flush() = 0;
  /// Bytes appended so far.
  [[nodiscard]] virtual std::uint64_t size() const = 0;
};

/// Where a recording comes from: random access to a fixed number of bytes.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  /// Fills `into` from `offset`; a range that does not lie inside size() is a failure.
  virtual Status read_at(std::uint64_t offset, std::span<std::byte> into) = 0;
  [[nodiscard]] virtual std::uint64_t size() const = 0;
};

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "services/core/recording/mcap/byte_stream.hpp"

namespace stillhand::recording {

/// Reads a source through one buffer, so that adjacent small records need one read.  The source
/// must outlive it.  Thread-compatible.
class SourceWindow {
 public:
  explicit SourceWindow(ByteSource& source) : source_(source) {}

  /// The bytes [offset, offset + count), valid until the next call.  Empty if they are not inside
  /// the source or the source failed (see status()).  The caller limits `count`.
  std::span<const std::byte> view(std::uint64_t offset, std::uint64_t count);

  /// First failure of the source, or ok.
  [[nodiscard]] const Status& status() const noexcept { return status_; }

 private:
  ByteSource& source_;
  Status status_;
  std::vector<std::byte> bytes_;
  std::uint64_t start_ = 0;
};

}  // namespace stillhand::recording

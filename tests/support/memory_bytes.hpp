// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <vector>

#include "services/core/recording/mcap/byte_stream.hpp"

namespace stillhand::recording {

/// Sink in memory.  `capacity_bytes` simulates a full disk: a write beyond it keeps the bytes that
/// fit and fails with kNoSpace.
class MemorySink : public ByteSink {
 public:
  explicit MemorySink(std::uint64_t capacity_bytes = UINT64_MAX)
      : capacity_bytes_(capacity_bytes) {}

  Status write(std::span<const std::byte> bytes) override {
    const std::uint64_t room = capacity_bytes_ - bytes_.size();
    const auto fits = static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(room, bytes.size()));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.begin() + fits);
    if (room < bytes.size()) return Status::failure(StatusKind::kNoSpace, "memory sink is full");
    return {};
  }
  Status flush() override { return {}; }
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }
  [[nodiscard]] const std::vector<std::byte>& bytes() const noexcept { return bytes_; }

 private:
  std::uint64_t capacity_bytes_;
  std::vector<std::byte> bytes_;
};

/// Source on memory that must outlive it.
class MemorySource : public ByteSource {
 public:
  explicit MemorySource(std::span<const std::byte> bytes) : bytes_(bytes) {}

  Status read_at(std::uint64_t offset, std::span<std::byte> into) override {
    if (offset > bytes_.size() || into.size() > bytes_.size() - offset) {
      return Status::failure(StatusKind::kIo, "read beyond the end");
    }
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(offset), into.size(), into.begin());
    return {};
  }
  [[nodiscard]] std::uint64_t size() const override { return bytes_.size(); }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/source_window.hpp"

#include <algorithm>

namespace stillhand::recording {
namespace {

// Large enough to avoid a system call for each 100-byte message of a scan, small compared with a
// chunk.
constexpr std::uint64_t kWindowBytes = 65'536;

}  // namespace

std::span<const std::byte> SourceWindow::view(std::uint64_t offset, std::uint64_t count) {
  const std::uint64_t size = source_.size();
  if (!status_.ok() || offset > size || count > size - offset) return {};
  if (offset < start_ || offset + count > start_ + bytes_.size()) {
    const std::uint64_t wanted = std::min(std::max(count, kWindowBytes), size - offset);
    bytes_.resize(static_cast<std::size_t>(wanted));
    start_ = offset;
    status_ = source_.read_at(offset, bytes_);
    if (!status_.ok()) {
      bytes_.clear();
      return {};
    }
  }
  return std::span(bytes_).subspan(static_cast<std::size_t>(offset - start_),
                                   static_cast<std::size_t>(count));
}

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#include "services/core/recording/mcap/crc32.hpp"

#include <zlib.h>

namespace stillhand::recording {

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) noexcept {
  // An empty span may have no address, which zlib takes as "give me the start value".
  if (bytes.empty()) return before;
  return static_cast<std::uint32_t>(
      ::crc32_z(before, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

}  // namespace stillhand::recording

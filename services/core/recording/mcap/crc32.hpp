// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace stillhand::recording {

/// CRC-32 of MCAP (IEEE 802.3, reflected polynomial 0xEDB88320), computed by zlib.  For several
/// pieces, pass the result of the previous piece as `before`.  Pure.
std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before = 0) noexcept;

}  // namespace stillhand::recording

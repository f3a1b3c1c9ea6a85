// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "services/core/device_rig/moteus_frame.hpp"

namespace stillhand::device_rig::moteus {

/// A CAN-FD frame as Linux's raw CAN sockets carry it, METHOD Eq. DR-34: `struct canfd_frame` of
/// <linux/can.h>, 72 bytes in the machine's byte order.
struct CanRecord {
  static constexpr std::size_t kSize = 72;
  std::array<char, kSize> bytes{};

  [[nodiscard]] std::string_view view() const noexcept { return {bytes.data(), kSize}; }
};

/// @param identifier  16 bit: source << 8 | destination; 0x8000 asks for a reply.  The frame is an
///                    extended one where more than 11 bits are needed
/// @param frame       of a length that CAN-FD knows: FrameWriter::pad()
CanRecord record_of(std::uint32_t identifier, const Frame& frame) noexcept;

/// A frame of the bus.
struct CanFrame {
  std::uint32_t identifier = 0;
  Frame frame;
};

/// @param bytes  one read of a socket: a CAN-FD frame of 72 bytes, or a classic one of 16
/// @returns nothing for an error or remote frame, or another size
std::optional<CanFrame> read_record(std::string_view bytes) noexcept;

}  // namespace stillhand::device_rig::moteus

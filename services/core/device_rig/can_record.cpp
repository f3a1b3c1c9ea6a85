// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/can_record.hpp"

#include <cstring>

namespace stillhand::device_rig::moteus {
namespace {

// Places and flags of <linux/can.h>, which a core does not include.
constexpr std::size_t kLength = 4;
constexpr std::size_t kFlags = 5;
constexpr std::size_t kPayload = 8;
constexpr std::size_t kClassicSize = 16;
constexpr std::uint32_t kExtended = 0x80000000u;
constexpr std::uint32_t kRemote = 0x40000000u;
constexpr std::uint32_t kErrorFrame = 0x20000000u;
constexpr std::uint32_t kIdentifier = 0x1fffffffu;
constexpr std::uint32_t kStandardMost = 0x7ffu;
constexpr char kRateSwitch = 0x01;  // the payload at 5 Mbit/s

}  // namespace

CanRecord record_of(std::uint32_t identifier, const Frame& frame) noexcept {
  CanRecord record;
  const std::uint32_t word =
      (identifier & kIdentifier) | (identifier > kStandardMost ? kExtended : 0u);
  std::memcpy(record.bytes.data(), &word, sizeof(word));
  record.bytes[kLength] = static_cast<char>(frame.size);
  record.bytes[kFlags] = kRateSwitch;
  std::memcpy(record.bytes.data() + kPayload, frame.bytes.data(), frame.size);
  return record;
}

std::optional<CanFrame> read_record(std::string_view bytes) noexcept {
  if (bytes.size() != CanRecord::kSize && bytes.size() != kClassicSize) return std::nullopt;
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data(), sizeof(word));
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(bytes[kLength]));
  if ((word & (kRemote | kErrorFrame)) != 0 || length > bytes.size() - kPayload) {
    return std::nullopt;
  }
  CanFrame read;
  read.identifier = word & kIdentifier;
  read.frame.size = length;
  std::memcpy(read.frame.bytes.data(), bytes.data() + kPayload, length);
  return read;
}

}  // namespace stillhand::device_rig::moteus

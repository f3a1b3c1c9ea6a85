// SPDX-License-Identifier: Apache-2.0
#include <zlib.h>

#include <bit>
#include <cmath>

#include "services/core/device_rig/platform_protocol.hpp"

namespace stillhand::device_rig::plain {
namespace {

constexpr std::uint32_t kCommandMagic = 0x43504853;  // "SHPC"
constexpr std::uint32_t kStateMagic = 0x53504853;    // "SHPS"
constexpr std::uint32_t kVersion = 2;
constexpr std::size_t kStateSize = 52;

class Writer {
 public:
  explicit Writer(Packet& packet) noexcept : packet_(packet) {}
  void put(std::uint64_t value, std::size_t size) noexcept {
    for (std::size_t i = 0; i < size; ++i) {
      packet_.bytes[packet_.size++] = static_cast<std::uint8_t>(value >> (8 * i) & 0xffu);
    }
  }
  void put(double value) noexcept { put(std::bit_cast<std::uint64_t>(value), 8); }

 private:
  Packet& packet_;
};

std::uint64_t number(std::span<const std::uint8_t> bytes, std::size_t at,
                     std::size_t size) noexcept {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size; ++i) value |= std::uint64_t{bytes[at + i]} << (8 * i);
  return value;
}

double real(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return std::bit_cast<double>(number(bytes, at, 8));
}

std::uint32_t checksum(std::span<const std::uint8_t> bytes) noexcept {
  return static_cast<std::uint32_t>(crc32(0, bytes.data(), static_cast<uInt>(bytes.size())));
}

}  // namespace

Packet command_packet(const SetPoint& wanted, std::uint32_t sequence, std::uint32_t token,
                      std::uint32_t valid_ms) noexcept {
  const bool finite = std::isfinite(wanted.position_m) && std::isfinite(wanted.velocity_m_s) &&
                      std::isfinite(wanted.acceleration_m_s2);
  const SetPoint set_point = finite ? wanted : SetPoint{};
  Packet packet;
  Writer writer(packet);
  writer.put(kCommandMagic, 4);
  writer.put(kVersion, 2);
  writer.put(set_point.order == PlatformOrder::kFollow ? 1 : 0, 2);
  writer.put(sequence, 4);
  writer.put(token, 4);
  writer.put(valid_ms, 4);
  writer.put(set_point.position_m);
  writer.put(set_point.velocity_m_s);
  writer.put(set_point.acceleration_m_s2);
  writer.put(checksum(packet.payload()), 4);
  return packet;
}

PlatformReply read_reply(std::span<const std::uint8_t> payload) noexcept {
  PlatformReply reply;
  if (payload.size() != kStateSize || number(payload, 0, 4) != kStateMagic ||
      number(payload, 4, 2) != kVersion || number(payload, 6, 2) > 3 ||
      number(payload, kStateSize - 4, 4) != checksum(payload.first(kStateSize - 4))) {
    return reply;
  }
  reply.stage = static_cast<PlatformStage>(number(payload, 6, 2));
  reply.sequence = static_cast<std::uint32_t>(number(payload, 8, 4));
  reply.answers = static_cast<std::uint32_t>(number(payload, 12, 4));
  reply.owner = static_cast<std::uint32_t>(number(payload, 16, 4));
  reply.position_m = real(payload, 20);
  reply.velocity_m_s = real(payload, 28);
  reply.acceleration_m_s2 = real(payload, 36);
  reply.fault = static_cast<std::uint32_t>(number(payload, 44, 4));
  // An acceleration may be NaN: not measured.
  reply.whole = std::isfinite(reply.position_m) && std::isfinite(reply.velocity_m_s) &&
                !std::isinf(reply.acceleration_m_s2);
  return reply;
}

}  // namespace stillhand::device_rig::plain

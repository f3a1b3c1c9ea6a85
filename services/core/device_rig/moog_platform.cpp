// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>

#include "services/core/device_rig/platform_protocol.hpp"

namespace stillhand::device_rig::moog {
namespace {

constexpr std::size_t kReplySize = 40;
// Low nibble of the state.
constexpr std::uint32_t kIdle = 1;
constexpr std::uint32_t kStandby = 2;
constexpr std::uint32_t kEngaged = 3;
constexpr std::uint32_t kParking = 7;

void put(Packet& packet, std::uint32_t value) noexcept {
  for (int shift = 24; shift >= 0; shift -= 8) {
    packet.bytes[packet.size++] = static_cast<std::uint8_t>(value >> shift & 0xffu);
  }
}

void put(Packet& packet, double value) noexcept {
  put(packet, std::bit_cast<std::uint32_t>(static_cast<float>(value)));
}

std::uint32_t number(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return std::uint32_t{bytes[at]} << 24 | std::uint32_t{bytes[at + 1]} << 16 |
         std::uint32_t{bytes[at + 2]} << 8 | std::uint32_t{bytes[at + 3]};
}

double real(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return std::bit_cast<float>(number(bytes, at));
}

// A fault is never reset from here: a person does that, at the machine.
std::uint32_t word_for(PlatformOrder order, std::uint32_t state) noexcept {
  if (state > kParking) return kDisable;
  if (order == PlatformOrder::kRelease) return kPark;
  if (state == kEngaged) return kNewPosition;
  const bool follow = order == PlatformOrder::kFollow;
  if (follow && (state == kIdle || state == kStandby)) return kEngage;
  return kPark;
}

PlatformStage stage_of(std::uint32_t state) noexcept {
  if (state > kParking) return PlatformStage::kFault;
  if (state == kEngaged) return PlatformStage::kFollowing;
  return state == kStandby ? PlatformStage::kHolding : PlatformStage::kOff;
}

}  // namespace

Packet command_packet(const SetPoint& wanted, std::uint32_t machine_state,
                      double heave_m) noexcept {
  const SetPoint set_point = std::isfinite(wanted.position_m) ? wanted : SetPoint{};
  Packet packet;
  put(packet, word_for(set_point.order, machine_state));
  put(packet, 0.0);  // roll
  put(packet, 0.0);  // pitch
  put(packet, heave_m);
  put(packet, 0.0);  // surge
  put(packet, 0.0);  // yaw
  put(packet, set_point.position_m);
  put(packet, std::uint32_t{0});  // spare
  return packet;
}

PlatformReply read_reply(std::span<const std::uint8_t> payload,
                         std::uint32_t& machine_state) noexcept {
  PlatformReply reply;
  if (payload.size() != kReplySize) return reply;
  reply.position_m = real(payload, 32);  // roll, pitch, heave, surge, yaw, lateral
  if (!std::isfinite(reply.position_m)) return reply;
  reply.whole = true;
  reply.fault = number(payload, 0);
  machine_state = number(payload, 8) & 15u;
  reply.stage = reply.fault != 0 ? PlatformStage::kFault : stage_of(machine_state);
  return reply;
}

}  // namespace stillhand::device_rig::moog

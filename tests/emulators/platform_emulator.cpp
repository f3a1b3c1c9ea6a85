// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/platform_emulator.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace stillhand::emulators {
namespace {

// The two packets as the protocol's table prints them; this machine is little-endian, as they are.
#pragma pack(push, 1)
struct CommandPacket {
  char magic[4];
  std::uint16_t version, order;
  std::uint32_t sequence, token, valid_ms;
  double position_m, velocity_m_s, acceleration_m_s2;
  std::uint32_t crc;
};
struct StatePacket {
  char magic[4];
  std::uint16_t version, state;
  std::uint32_t sequence, newest_command, owner;
  double position_m, velocity_m_s, acceleration_m_s2;
  std::uint32_t fault, crc;
};
#pragma pack(pop)
static_assert(sizeof(CommandPacket) == 48 && sizeof(StatePacket) == 52);

std::uint32_t crc_of(const void* bytes, std::size_t size) {
  constexpr std::uint32_t kReversedPolynomial = 0xedb88320;
  std::uint32_t crc = ~0u;
  for (std::size_t i = 0; i < size; ++i) {
    crc ^= static_cast<const std::uint8_t*>(bytes)[i];
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1u) != 0 ? crc >> 1 ^ kReversedPolynomial : crc >> 1;
    }
  }
  return ~crc;
}

}  // namespace

std::vector<std::uint8_t> PlatformEmulator::take(std::span<const std::uint8_t> datagram,
                                                 std::int64_t now_ns) {
  CommandPacket command{};
  if (datagram.size() == sizeof(command)) {
    std::memcpy(&command, datagram.data(), sizeof(command));
  }
  if (std::memcmp(command.magic, "SHPC", 4) != 0 || command.version != 2 ||
      command.crc != crc_of(&command, sizeof(command) - 4)) {
    ++refused_;
    return {};
  }
  ++commands_;
  asked_ = command.sequence;
  if (owner_ != 0 && !wish(now_ns)) owner_ = 0;
  if (owner_ == 0 || owner_ == command.token)
    execute(command.order == 1, command.token, now_ns,
            {command.position_m, command.velocity_m_s, command.acceleration_m_s2},
            command.valid_ms);

  StatePacket state{};
  std::memcpy(state.magic, "SHPS", 4);
  state.version = 2;
  state.state = fault_ != 0 ? 3 : follow_ ? 2 : 1;
  state.sequence = ++sequence_;
  state.newest_command = asked_;
  state.owner = owner_;
  state.position_m = seat_.position_m;
  state.velocity_m_s = seat_.velocity_m_s;
  state.acceleration_m_s2 = seat_.acceleration_m_s2;
  state.fault = fault_;
  state.crc = crc_of(&state, sizeof(state) - 4);
  std::vector<std::uint8_t> reply(sizeof(state));
  std::memcpy(reply.data(), &state, sizeof(state));
  return reply;
}

void PlatformEmulator::execute(bool follow, std::uint32_t token, std::int64_t now_ns,
                               const PlatformWish& wish, std::uint32_t valid_ms) {
  if (follow_ && follow) {
    most_step_m_ = std::max(most_step_m_, std::abs(wish.position_m - wish_.position_m));
  }
  follow_ = follow && fault_ == 0;
  owner_ = follow_ ? token : 0;
  wish_ = wish;
  valid_ns_ = std::int64_t{valid_ms} * 1'000'000;
  command_ns_ = now_ns;
}

std::optional<PlatformWish> PlatformEmulator::wish(std::int64_t now_ns) const {
  if (!follow_ || fault_ != 0 || now_ns - command_ns_ > valid_ns_) return std::nullopt;
  return wish_;
}

}  // namespace stillhand::emulators

// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/moog_emulator.hpp"

#include <array>
#include <bit>

namespace stillhand::emulators {
namespace {

constexpr std::int64_t kMachine_ns = 500'000'000;
constexpr std::size_t kWords = 8, kReplyWords = 10;

std::uint32_t word(std::span<const std::uint8_t> bytes, std::size_t index) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | bytes[4 * index + i];
  return value;
}

}  // namespace

void MoogEmulator::pass(std::int64_t now_ns) {
  if (fault_ != 0) {
    state_ = kFault;
    engaging_ = false;
  } else if (state_ == kFault) {
    state_ = kStandby;  // a person reset it
  }
  if (now_ns - since_ns_ < kMachine_ns) return;
  if (engaging_) {
    state_ = kEngaged;
    wish_m_ = position_m_;
  }
  engaging_ = false;
  if (state_ == kParking) state_ = kStandby;
}

std::vector<std::uint8_t> MoogEmulator::take(std::span<const std::uint8_t> datagram,
                                             std::int64_t now_ns) {
  constexpr std::uint32_t kNewPosition = 130, kEngage = 180, kPark = 210;
  if (datagram.size() != 4 * kWords) return {};
  pass(now_ns);
  const std::uint32_t asked = word(datagram, 0);
  if (asked == kNewPosition && state_ == kEngaged)
    wish_m_ = std::bit_cast<float>(word(datagram, 6));
  if (asked == kEngage && !engaging_ && (state_ == kIdle || state_ == kStandby)) {
    engaging_ = true;
    since_ns_ = now_ns;
  }
  if (asked == kPark && (engaging_ || state_ == kEngaged)) {
    engaging_ = false;
    state_ = kParking;
    since_ns_ = now_ns;
  }
  std::array<std::uint32_t, kReplyWords> reply{};
  reply[0] = fault_;
  reply[2] = state_;
  reply[8] = std::bit_cast<std::uint32_t>(static_cast<float>(position_m_));
  std::vector<std::uint8_t> bytes;
  for (const std::uint32_t each : reply) {
    for (int shift = 24; shift >= 0; shift -= 8) {
      bytes.push_back(static_cast<std::uint8_t>(each >> shift & 0xffu));
    }
  }
  return bytes;
}

std::optional<double> MoogEmulator::wish_m() const {
  if (state_ != kEngaged) return std::nullopt;
  return wish_m_;
}

}  // namespace stillhand::emulators

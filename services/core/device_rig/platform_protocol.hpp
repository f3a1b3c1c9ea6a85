// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

namespace stillhand::device_rig {

/// What a platform does.
enum class PlatformStage : std::uint8_t { kOff = 0, kHolding = 1, kFollowing = 2, kFault = 3 };

/// What a platform is asked for.
enum class PlatformOrder : std::uint8_t {
  kRelease,  ///< brake by itself, and no set-point until another kFollow; a Moog parks
  kHold,     ///< brake and hold; a platform that stays engaged holds the set-point
  kFollow    ///< follow the set-point; engage first
};

/// One set-point of the platform, lateral, + to the subject's right.
struct SetPoint {
  PlatformOrder order = PlatformOrder::kRelease;
  double position_m = 0.0;
  double velocity_m_s = 0.0;
  double acceleration_m_s2 = 0.0;
};

/// State of the platform, as one packet reports it.
struct PlatformReply {
  bool whole = false;  ///< the packet is one of this protocol, undamaged, its numbers are numbers
  PlatformStage stage = PlatformStage::kOff;
  std::uint32_t sequence = 0;  ///< 0 where the protocol has none
  std::uint32_t answers = 0;   ///< sequence of the newest command, same
  std::uint32_t owner = 0;     ///< token of whom it follows; 0: nobody, or no token
  double position_m = kNone;
  double velocity_m_s = kNone;
  double acceleration_m_s2 = kNone;  ///< measured at the seat
  std::uint32_t fault = 0;

  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
};

/// A packet to a platform.
struct Packet {
  std::array<std::uint8_t, 64> bytes{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

/// The plain protocol, METHOD "The plain platform protocol": little-endian, CRC-32 at the end.
namespace plain {
/// @param set_point  one that is not finite becomes kRelease
/// @param token      of this process, not 0
/// @param valid_ms   the platform brakes and holds if no newer packet comes for so long
Packet command_packet(const SetPoint& set_point, std::uint32_t sequence, std::uint32_t token,
                      std::uint32_t valid_ms) noexcept;
PlatformReply read_reply(std::span<const std::uint8_t> payload) noexcept;
}  // namespace plain

/// Moog 6DOF2000E: big-endian, 60 Hz, six axes of which Stillhand moves the lateral one.  Source:
/// E. Loewenthal's header (2018), by way of METHOD "Moog".  Not tried on a machine.
namespace moog {
inline constexpr std::uint32_t kNewPosition = 130;
inline constexpr std::uint32_t kEngage = 180;
inline constexpr std::uint32_t kPark = 210;
inline constexpr std::uint32_t kDisable = 220;
/// @param set_point      one that is not finite becomes kRelease
/// @param machine_state  low nibble of the newest reply's state; chooses the command word
/// @param heave_m        height at which the machine works, of its own frame
Packet command_packet(const SetPoint& set_point, std::uint32_t machine_state,
                      double heave_m) noexcept;
/// @param machine_state  gets the low nibble of the state
PlatformReply read_reply(std::span<const std::uint8_t> payload,
                         std::uint32_t& machine_state) noexcept;
}  // namespace moog

}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "tests/emulators/platform_emulator.hpp"

namespace stillhand::emulators {

/// The lateral axis of a Moog 6DOF2000E, as far as its packets say: idle, engaging, engaged,
/// parking, standby, fault.  Nothing is known of the times a machine takes; here it engages and
/// parks in half a second, and does not move sideways meanwhile.  Engaged it goes to the newest
/// position, at which it stays without a packet.  The clock is the caller's.
class MoogEmulator {
 public:
  /// @returns the reply to send; empty: the datagram is no command
  std::vector<std::uint8_t> take(std::span<const std::uint8_t> datagram, std::int64_t now_ns);
  /// Where it goes to; nothing: it stands.
  [[nodiscard]] std::optional<double> wish_m() const;
  void stand(double position_m) { position_m_ = position_m; }
  void fault(std::uint32_t bits) { fault_ = bits; }

 private:
  enum State : std::uint32_t { kIdle = 1, kStandby = 2, kEngaged = 3, kParking = 7, kFault = 10 };

  void pass(std::int64_t now_ns);

  std::uint32_t state_ = kIdle, fault_ = 0;
  bool engaging_ = false;
  std::int64_t since_ns_ = 0;
  double wish_m_ = 0.0, position_m_ = 0.0;
};

}  // namespace stillhand::emulators

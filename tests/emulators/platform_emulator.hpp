// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace stillhand::emulators {

/// What the platform was asked for.
struct PlatformWish {
  double position_m, velocity_m_s, acceleration_m_s2;
};

/// What the platform does.
struct SeatState {
  double position_m = 0.0;
  double velocity_m_s = 0.0;
  double acceleration_m_s2 = 0.0;
};

/// A platform that speaks the plain protocol (services/devices/device_rig, METHOD), written from
/// that text alone: it shares no code with the driver.  The clock is the caller's.
class PlatformEmulator {
 public:
  /// @returns the reply to send; empty: the datagram is no command
  std::vector<std::uint8_t> take(std::span<const std::uint8_t> datagram, std::int64_t now_ns);
  /// What it follows; nothing: it brakes and holds.
  [[nodiscard]] std::optional<PlatformWish> wish(std::int64_t now_ns) const;
  void stand(const SeatState& seat) { seat_ = seat; }
  void fault(std::uint32_t bits) { fault_ = bits; }
  [[nodiscard]] std::uint64_t refused() const { return refused_; }
  [[nodiscard]] std::uint64_t commands() const { return commands_; }
  /// Largest step from one set-point to the next.
  [[nodiscard]] double most_step_m() const { return most_step_m_; }

 private:
  void execute(bool follow, std::uint32_t token, std::int64_t now_ns, const PlatformWish& wish,
               std::uint32_t valid_ms);

  SeatState seat_;
  PlatformWish wish_{};
  bool follow_ = false;
  std::uint32_t owner_ = 0;
  std::int64_t command_ns_ = 0;
  std::int64_t valid_ns_ = 0;
  std::uint32_t sequence_ = 0, asked_ = 0, fault_ = 0;
  std::uint64_t refused_ = 0, commands_ = 0;
  double most_step_m_ = 0.0;
};

}  // namespace stillhand::emulators

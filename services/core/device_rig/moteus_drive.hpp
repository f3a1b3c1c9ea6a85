// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "services/core/device_rig/drive_reply.hpp"
#include "services/core/device_rig/moteus_frame.hpp"

namespace stillhand::device_rig::moteus {

/// Modes of register 0x000 that Stillhand commands or meets.
enum Mode : int {
  kStopped = 0,
  kFaulted = 1,
  kInPosition = 10,
  kTimedOut = 11,
  kZeroVelocity = 12,
};

/// What one torque command says.
struct TorqueCommand {
  double torque_n_m = 0.0;      ///< at the output
  double max_torque_n_m = 0.0;  ///< the drive's own bound for this command
  double watchdog_s = 0.0;      ///< the command counts for so long
};

/// A pure torque, METHOD Eq. DR-3: mode 10 with position NaN, kp, kd and the integral's limit 0.
/// Mode 10 because only there the drive's watchdog trips; in current mode it never does.  Every
/// command writes the mode, since nothing else feeds the watchdog, and carries the watchdog's time.
/// The frame also asks for the reply of query().
/// A torque that is not finite becomes 0, and one beyond the bound the bound.
Frame torque_frame(const TorqueCommand& command) noexcept;
/// Mode 0: driver off.  It clears a fault and a timeout, which latch until then.
Frame stop_frame() noexcept;
/// Asks for the state alone.  It does not feed the watchdog.
Frame query_frame() noexcept;

/// State of the drive, as one reply reports it.  Whole: mode, position, velocity, torque and fault
/// were in it.
DriveReply read_reply(std::span<const std::uint8_t> payload) noexcept;

/// The drive's serial number, least significant word first.
using SerialNumber = std::array<std::uint32_t, 3>;
/// Asks for the serial number alone.
Frame serial_frame() noexcept;
/// Nothing if the frame is not the answer to serial_frame().
std::optional<SerialNumber> read_serial(std::span<const std::uint8_t> payload) noexcept;

}  // namespace stillhand::device_rig::moteus

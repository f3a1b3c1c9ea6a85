// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace stillhand::device_rig::moteus {

/// Registers of a moteus drive that Stillhand uses.  Source: mjbots/moteus,
/// docs/protocol/registers.md.
enum Register : std::uint32_t {
  kMode = 0x000,
  kPosition = 0x001,  ///< [rev] of the output
  kVelocity = 0x002,  ///< [rev/s]
  kTorque = 0x003,    ///< [N m] at the output
  kVoltage = 0x00d,
  kTemperature = 0x00e,
  kFault = 0x00f,
  kCommandPosition = 0x020,  ///< NaN: from where the drive is
  kCommandVelocity = 0x021,
  kCommandTorque = 0x022,  ///< feed-forward
  kCommandKpScale = 0x023,
  kCommandKdScale = 0x024,
  kCommandMaxTorque = 0x025,
  kCommandTimeout = 0x027,  ///< [s] 0: the configured default; NaN: none
  kCommandIlimitScale = 0x02b,
  kAnalog1 = 0x060,       ///< [-] 0 to 1, first of AUX1
  kAnalog2 = 0x068,       ///< [-] 0 to 1, first of AUX2
  kMilliseconds = 0x070,  ///< counter, wraps
  kSerialNumber = 0x120,  ///< 96 bit in three registers, least significant word first
};

/// How a value travels; its place in the type byte of a subframe.
enum class Resolution : std::uint8_t { kInt8 = 0, kInt16 = 1, kInt32 = 2, kFloat = 3 };

/// One step of an integer of that resolution, in the unit of the register; 1 for plain numbers.
double step_of(std::uint32_t address, Resolution resolution) noexcept;
/// Whether the most negative integer of a register means NaN.  Mode, fault and counter have all
/// their values.
bool has_nan(std::uint32_t address) noexcept;

}  // namespace stillhand::device_rig::moteus

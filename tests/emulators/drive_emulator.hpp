// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace stillhand::emulators {

/// What a drive measures.
struct DriveSenses {
  double position_rev = 0.0;
  double velocity_rev_s = 0.0;
  double analog1 = 0.5;
  double analog2 = 0.5;
};

/// What the drive saw of the host, for tests.
struct DriveRecord {
  std::uint64_t commands = 0;          ///< torque commands of a drive that follows or was asked to
  std::uint64_t stops = 0;             ///< driver off
  std::uint64_t queries = 0;           ///< questions without a command
  std::uint64_t other_modes = 0;       ///< any other mode or state; none is right
  std::uint64_t without_watchdog = 0;  ///< commands that would count for ever
  std::uint64_t with_gains = 0;        ///< commands that leave a gain or a position
  std::uint64_t without_bound = 0;     ///< commands without a largest torque
  std::uint64_t timeouts = 0;
  double most_torque_n_m = 0.0;
  double first_torque_n_m = 0.0;  ///< largest of a first command after a stop
  double torque_after_ms = 0.0;   ///< longest time from a command to the end of its torque
};

/// A servo drive that is not there: bytes of the host in, bytes of the drive out, torque on the
/// stick's shaft.  The clock is the caller's.
class DriveEmulator {
 public:
  virtual ~DriveEmulator() = default;

  /// Bytes of the host; returns the answer.
  virtual std::string take(std::string_view bytes, std::int64_t now_ns) = 0;
  /// The drive's own clock goes on: watchdog and torque.
  virtual void tick(std::int64_t now_ns) = 0;
  virtual void sense(const DriveSenses& senses) = 0;
  [[nodiscard]] virtual double torque_n_m() const = 0;
  /// Its driver is on and follows commands.
  [[nodiscard]] virtual bool follows() const = 0;
  /// Number of its mode or state.
  [[nodiscard]] virtual int mode() const = 0;
  [[nodiscard]] virtual const DriveRecord& record() const = 0;

  /// Its counter is 0 now.
  virtual void begin(std::int64_t now_ns) = 0;
  /// Off and on again: settings from its memory, counter from 0.
  virtual void reboot(std::int64_t now_ns) = 0;
  virtual void fault(int code) = 0;
  virtual void set(const std::string& name, const std::string& value) = 0;
  /// A register or property that this firmware does not know.
  virtual void forget(std::uint32_t address) = 0;
  /// Another drive in its place.
  virtual void be(std::uint32_t serial) = 0;
  /// The encoder gives no position.
  virtual void lose_position(bool lost) = 0;
};

}  // namespace stillhand::emulators

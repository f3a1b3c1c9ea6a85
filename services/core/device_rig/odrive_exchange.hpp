// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "services/core/device_rig/odrive_line.hpp"

namespace stillhand::device_rig::odrive {

/// States of an axis that Stillhand commands.  Source: Firmware/odrive-interface.yaml, AxisState.
enum AxisState : std::uint64_t { kIdle = 1, kClosedLoop = 8 };
/// Bit of axis.error: the watchdog tripped.  Source: the same file.
inline constexpr std::uint64_t kWatchdogExpired = 0x800;

/// One word more that an exchange asks for, in turn: what only explains a fault needs no place in
/// each exchange.
enum class Extra : std::uint8_t { kMotorError, kEncoderError, kControllerError, kCurrent };
Extra extra_of(std::uint64_t number) noexcept;

/// Adds the questions of exchange `number` to the lines, METHOD Eq. DR-31.
void put_questions(Lines& lines, std::size_t axis, std::uint64_t number) noexcept;

/// The answers to the questions of one exchange.
struct Answers {
  std::uint64_t number = 0;
  double position_turns = 0.0;
  double velocity_turns_s = 0.0;
  std::uint64_t state = 0;
  std::uint64_t uptime_ms = 0;
  std::uint64_t axis_error = 0;
  double extra = 0.0;  ///< of extra_of(number)
};

/// Matches answers to questions, METHOD Eq. DR-31: the protocol gives an answer no address.  The
/// first answer of an exchange alone has two numbers, so it begins one; the others must follow in
/// their order; the last must be the number of an exchange that was asked and not answered yet.
/// Pure; one thread; never allocates.
class AnswerReader {
 public:
  static constexpr std::uint64_t kFirst = 1000;        ///< no state of an axis is as large
  static constexpr std::uint64_t kLast = 999'999'999;  ///< the drive cuts an answer to 9 digits
  static constexpr std::uint64_t kMostAnswers = 6;

  enum class Verdict : std::uint8_t { kMore, kDamaged, kWhole };

  /// The number of the next exchange.
  std::uint64_t ask() noexcept;
  /// @param line  of the drive, with its checksum
  Verdict take(std::string_view line) noexcept;
  /// Of the newest whole exchange.
  [[nodiscard]] const Answers& answers() const noexcept { return answers_; }
  /// Forgets answers of which not all came.
  void clear() noexcept { place_ = 0; }

 private:
  Verdict begin(std::string_view position, std::string_view velocity) noexcept;
  bool put(std::string_view text) noexcept;

  Answers answers_, coming_;
  std::uint64_t place_ = 0;           ///< answers that came of the present exchange
  bool with_point_ = false;           ///< the extra one has decimals
  std::uint64_t asked_ = kFirst - 1;  ///< newest number
  std::uint64_t answered_ = kFirst - 1;
};

}  // namespace stillhand::device_rig::odrive

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string_view>

#include "services/core/device_rig/moteus_registers.hpp"

namespace stillhand::device_rig::moteus {

/// Payload of one CAN-FD frame.
struct Frame {
  static constexpr std::size_t kMost = 64;
  std::array<std::uint8_t, kMost> bytes{};
  std::size_t size = 0;

  [[nodiscard]] std::span<const std::uint8_t> payload() const noexcept {
    return {bytes.data(), size};
  }
};

/// Puts subframes into a frame.  What does not fit makes good() false and is left out.  Source:
/// mjbots/moteus, docs/protocol/can.md; METHOD Eq. DR-1.  Pure; never allocates.
class FrameWriter {
 public:
  explicit FrameWriter(Frame& frame) noexcept : frame_(frame) { frame_.size = 0; }

  /// Values of consecutive registers.  NaN becomes the most negative integer, which means NaN.
  void write(Resolution resolution, Register first, std::initializer_list<double> values) noexcept;
  void read(Resolution resolution, Register first, std::uint32_t count) noexcept;
  /// Text to the drive's configuration console.
  void to_console(std::string_view text) noexcept;
  /// Asks for what the console has to say, at most `most` bytes.
  void poll_console(std::uint32_t most) noexcept;
  /// Fills up to a length that CAN-FD knows, with subframes that do nothing.
  void pad() noexcept;
  [[nodiscard]] bool good() const noexcept { return good_; }

 private:
  void byte(std::uint32_t value) noexcept;
  void varuint(std::uint32_t value) noexcept;
  void head(std::uint32_t type, Resolution resolution, Register first,
            std::uint32_t count) noexcept;
  void value(Resolution resolution, std::uint32_t address, double value) noexcept;

  Frame& frame_;
  bool good_ = true;
};

/// Takes subframes out of a frame, one value at a time.  Pure; never allocates.
class FrameReader {
 public:
  enum class Kind : std::uint8_t { kValue, kWriteError, kReadError, kConsole };
  struct Item {
    Kind kind;
    std::uint32_t address = 0;                   ///< register
    double value = 0.0;                          ///< NaN: the drive has none
    std::uint32_t error = 0;                     ///< number of an error
    std::span<const std::uint8_t> console = {};  ///< text of the console
  };

  explicit FrameReader(std::span<const std::uint8_t> payload) noexcept : rest_(payload) {}
  /// The next item; nothing at the end of the frame or of what can be understood.
  std::optional<Item> next() noexcept;
  /// Everything up to the end was understood.
  [[nodiscard]] bool sound() const noexcept { return sound_; }

 private:
  std::optional<std::uint32_t> byte() noexcept;
  std::optional<std::uint32_t> varuint() noexcept;
  std::optional<Item> begin(std::uint32_t type) noexcept;
  std::optional<Item> value() noexcept;
  std::optional<Item> fail() noexcept;

  std::span<const std::uint8_t> rest_;
  Resolution resolution_ = Resolution::kInt8;
  std::uint32_t address_ = 0;
  std::uint32_t left_ = 0;  ///< values of the present subframe
  bool sound_ = true;
};

}  // namespace stillhand::device_rig::moteus

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace stillhand::device_rig::odrive {

/// XOR of all characters.  Source: odriverobotics/ODrive at a5f4efe, docs/ascii-protocol.md.
std::uint8_t checksum_of(std::string_view text) noexcept;

/// Lines to the drive, METHOD Eq. DR-30: "command *NN", NN the checksum of everything before the
/// star.  The drive ignores a line of a wrong checksum, and answers one with a checksum with one.
/// What does not fit is left out, and good() is false.  Never allocates.
class Lines {
 public:
  void clear() noexcept {
    size_ = 0;
    good_ = true;
  }
  void add(std::string_view command) noexcept;
  void add(std::string_view command, std::uint64_t value) noexcept;
  /// @param value  finite, with six decimals
  void add(std::string_view command, double value) noexcept;
  [[nodiscard]] std::string_view view() const noexcept { return {text_.data(), size_}; }
  [[nodiscard]] bool good() const noexcept { return good_; }

 private:
  void put(std::string_view text) noexcept;
  void end(std::size_t begin) noexcept;

  std::array<char, 512> text_{};
  std::size_t size_ = 0;
  bool good_ = true;
};

/// An answer without its checksum; nothing if the checksum is missing or wrong.
std::optional<std::string_view> read_line(std::string_view line) noexcept;
/// The whole text as a number; nothing otherwise.
std::optional<std::uint64_t> whole_of(std::string_view text) noexcept;
std::optional<double> real_of(std::string_view text) noexcept;

}  // namespace stillhand::device_rig::odrive

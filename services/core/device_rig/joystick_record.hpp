// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace stillhand::device_rig {

/// What a joystick is asked to do; 8 bytes.
struct ForceRecord {
  enum Kind : std::uint8_t { kAsk = 0, kStop = 1, kPlay = 2 };
  std::uint8_t kind = kAsk;
  std::uint8_t zero = 0;
  std::int16_t level = 0;       ///< of 32767
  std::uint16_t length_ms = 0;  ///< the kernel or the device ends the force after this time
  std::uint16_t zero_too = 0;
};
static_assert(sizeof(ForceRecord) == 8);

/// How a joystick stands; 20 bytes.
struct StickRecord {
  enum Mode : std::uint32_t { kOff = 0, kPlays = 1, kRanOut = 2, kRefused = 3 };
  std::int32_t value = 0, lowest = 0, highest = 0;  ///< of the left-right axis
  std::uint32_t milliseconds = 0;                   ///< of this machine, when it was read
  std::uint32_t mode = kOff;
};
static_assert(sizeof(StickRecord) == 20);

/// A record out of bytes, of its size alone.
template <typename Record>
std::optional<Record> record_in(std::string_view bytes) noexcept {
  if (bytes.size() != sizeof(Record)) return std::nullopt;
  Record record;
  std::memcpy(&record, bytes.data(), sizeof(record));
  return record;
}

/// When a force may play: one that ran out, since no other came in time, stays away until a stop,
/// as after the watchdog of a servo drive.  Pure.
class ForceLatch {
 public:
  /// @returns true if the force may play
  bool play(std::int64_t now_ns, std::uint16_t length_ms) noexcept {
    if (ran_out(now_ns)) return false;
    until_ns_ = now_ns + std::int64_t{length_ms} * 1'000'000;
    plays_ = true;
    return true;
  }
  void stop() noexcept { plays_ = ran_out_ = false; }
  [[nodiscard]] bool ran_out(std::int64_t now_ns) noexcept {
    ran_out_ = ran_out_ || (plays_ && now_ns > until_ns_);
    return ran_out_;
  }
  [[nodiscard]] bool plays() const noexcept { return plays_ && !ran_out_; }

 private:
  std::int64_t until_ns_ = 0;
  bool plays_ = false;
  bool ran_out_ = false;
};

}  // namespace stillhand::device_rig

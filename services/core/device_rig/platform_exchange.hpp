// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "services/core/device_rig/parts.hpp"
#include "services/core/device_rig/platform_protocol.hpp"

namespace stillhand::device_rig {

/// What is known of the platform.
struct PlatformSample {
  std::uint64_t count = 0;  ///< of whole replies; 0: none yet
  std::int64_t at_ns = 0;   ///< CLOCK_MONOTONIC, of the command that the newest reply answers; of a
                            ///< protocol without numbers: when the reply came
  PlatformReply reply;
  std::uint64_t damaged = 0;  ///< replies that were not whole, came again, or answer nothing
};

/// The language of a platform: set-points to packets, packets to samples.  A reply is as old as the
/// command that it answers, METHOD Eq. DR-20: late replies are old ones.  No clock, no descriptor;
/// never allocates or throws; one thread.
class PlatformExchange {
 public:
  /// @param token  of this process on the platform, not 0
  PlatformExchange(Parts::Platform protocol, std::uint32_t token, std::uint32_t valid_ms,
                   double heave_m) noexcept
      : protocol_(protocol), token_(token), valid_ms_(valid_ms), heave_m_(heave_m) {}

  Packet command(const SetPoint& set_point, std::int64_t now_ns) noexcept;
  /// @returns true for a new sample
  bool take(std::span<const std::uint8_t> datagram, std::int64_t now_ns) noexcept;
  [[nodiscard]] const PlatformSample& sample() const noexcept { return sample_; }

 private:
  static constexpr std::uint32_t kKept = 256;  ///< times of commands

  bool refuse() noexcept;

  Parts::Platform protocol_;
  std::uint32_t token_, valid_ms_;
  double heave_m_;
  PlatformSample sample_;
  std::uint32_t sequence_ = 0;
  std::uint32_t machine_state_ = 0;  ///< Moog
  std::array<std::int64_t, kKept> sent_ns_{};
};

}  // namespace stillhand::device_rig

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <thread>

#include "services/device_rig/core/devices_config.hpp"
#include "services/device_rig/core/parts.hpp"
#include "services/device_rig/core/platform_protocol.hpp"
#include "services/runtime/process/latest_value.hpp"
#include "services/runtime/transport/bell.hpp"
#include "services/runtime/transport/udp_socket.hpp"

namespace stillhand::device_rig {

/// What the platform's thread knows.
struct PlatformSample {
  std::uint64_t count = 0;  ///< of whole replies; 0: none yet
  std::int64_t at_ns = 0;   ///< CLOCK_MONOTONIC when the reply was read
  PlatformReply reply;
  std::uint64_t damaged = 0;
};

/// A platform behind UDP, in a thread of its own.  The loop stores a set-point and takes the newest
/// sample, without lock or allocation.  The thread sends each set-point once and none by itself, so
/// a loop that stops stops the platform (`valid_ms`).
class PlatformLink {
 public:
  /// @throws ConfigError for an address that is none
  PlatformLink(const PlatformLinkConfig& config, Parts::Platform protocol);
  ~PlatformLink();
  PlatformLink(const PlatformLink&) = delete;
  PlatformLink& operator=(const PlatformLink&) = delete;

  void demand(const SetPoint& set_point) noexcept;
  const PlatformSample& newest() noexcept { return samples_.load(); }

 private:
  struct Demand {
    std::uint64_t number = 0;
    SetPoint set_point;
  };
  void work(const std::stop_token& stop) noexcept;
  void receive() noexcept;
  void send(const SetPoint& set_point) noexcept;

  PlatformLinkConfig config_;
  Parts::Platform protocol_;
  runtime::UdpSocket socket_;
  runtime::Bell bell_;
  runtime::LatestValue<Demand> demands_;
  runtime::LatestValue<PlatformSample> samples_;
  std::uint64_t demand_number_ = 0;  // the loop's
  // The thread's.
  PlatformSample sample_;
  std::uint64_t sent_number_ = 0;
  std::uint32_t sequence_ = 0;
  std::uint32_t machine_state_ = 0;  ///< Moog
  std::jthread thread_;              // last
};

}  // namespace stillhand::device_rig

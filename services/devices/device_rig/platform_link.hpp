// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stop_token>
#include <thread>

#include "services/core/device_rig/devices_config.hpp"
#include "services/core/device_rig/parts.hpp"
#include "services/core/device_rig/platform_exchange.hpp"
#include "services/system/process/host_lock.hpp"
#include "services/system/process/latest_value.hpp"
#include "services/system/transport/bell.hpp"
#include "services/system/transport/udp_socket.hpp"

namespace stillhand::device_rig {

/// A platform behind UDP, in a thread of its own; one process of this machine has it.  The loop
/// stores a set-point and takes the newest sample, without lock or allocation.  The thread sends
/// each set-point once and none by itself, so a loop that stops stops the platform (`valid_ms`).
class PlatformLink {
 public:
  /// @throws ConfigError for an address that is none, or a platform that another process has
  PlatformLink(const PlatformLinkConfig& config, Parts::Platform protocol);
  ~PlatformLink();
  PlatformLink(const PlatformLink&) = delete;
  PlatformLink& operator=(const PlatformLink&) = delete;

  void demand(const SetPoint& set_point) noexcept;
  const PlatformSample& newest() noexcept { return samples_.load(); }
  /// Of this process, where the protocol has one.
  [[nodiscard]] std::uint32_t token() const noexcept { return token_; }

 private:
  struct Demand {
    std::uint64_t number = 0;
    std::int64_t at_ns = 0;
    SetPoint set_point;
  };
  void work(const std::stop_token& stop) noexcept;
  void receive() noexcept;
  void send(const SetPoint& set_point) noexcept;

  runtime::HostLock lock_;
  std::uint32_t token_;
  std::int64_t valid_ns_;
  runtime::UdpSocket socket_;
  runtime::Bell bell_;
  runtime::LatestValue<Demand> demands_;
  runtime::LatestValue<PlatformSample> samples_;
  std::uint64_t demand_number_ = 0;  // the loop's
  // The thread's.
  PlatformExchange exchange_;
  std::uint64_t sent_number_ = 0;
  std::jthread thread_;  // last
};

}  // namespace stillhand::device_rig

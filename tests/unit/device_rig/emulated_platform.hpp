// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <mutex>
#include <stop_token>
#include <thread>

#include "services/system/process/clock.hpp"
#include "tests/emulators/platform_emulator.hpp"

namespace stillhand::device_rig {

/// An emulated plain platform behind a UDP port, in a thread of its own.  It is where it was asked
/// to be.
class EmulatedPlatform {
 public:
  explicit EmulatedPlatform(double place_m) : socket_(socket(AF_INET, SOCK_DGRAM, 0)) {
    seat_.position_m = place_m;
    platform_.stand(seat_);
    sockaddr_in here{};
    here.sin_family = AF_INET;
    here.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof(here);
    bind(socket_, reinterpret_cast<const sockaddr*>(&here), sizeof(here));
    getsockname(socket_, reinterpret_cast<sockaddr*>(&here), &size);
    port_ = ntohs(here.sin_port);
    thread_ = std::jthread([this](const std::stop_token& stop) { answer(stop); });
  }
  ~EmulatedPlatform() {
    thread_.request_stop();
    thread_.join();
    close(socket_);
  }
  EmulatedPlatform(const EmulatedPlatform&) = delete;
  EmulatedPlatform& operator=(const EmulatedPlatform&) = delete;

  [[nodiscard]] int port() const { return port_; }
  /// Was asked to follow, once at least.
  bool followed() {
    const std::lock_guard lock(mutex_);
    return followed_;
  }
  double place_m() {
    const std::lock_guard lock(mutex_);
    return seat_.position_m;
  }

 private:
  void answer(const std::stop_token& stop) {
    std::array<std::uint8_t, 256> bytes{};
    while (!stop.stop_requested()) {
      pollfd wanted{socket_, POLLIN, 0};
      if (poll(&wanted, 1, 10) <= 0) continue;
      sockaddr_in from{};
      socklen_t size = sizeof(from);
      auto* address = reinterpret_cast<sockaddr*>(&from);
      const ssize_t count = recvfrom(socket_, bytes.data(), bytes.size(), 0, address, &size);
      if (count <= 0) continue;
      const std::lock_guard lock(mutex_);
      const std::int64_t now_ns = runtime::monotonic_ns();
      const auto reply =
          platform_.take(std::span(bytes).first(static_cast<std::size_t>(count)), now_ns);
      if (const auto wish = platform_.wish(now_ns)) {
        followed_ = true;
        seat_.position_m = wish->position_m;
        platform_.stand(seat_);
      }
      sendto(socket_, reply.data(), reply.size(), 0, address, size);
    }
  }

  int socket_, port_ = 0;
  std::mutex mutex_;
  emulators::PlatformEmulator platform_;
  emulators::SeatState seat_;
  bool followed_ = false;
  std::jthread thread_;  // last
};

}  // namespace stillhand::device_rig

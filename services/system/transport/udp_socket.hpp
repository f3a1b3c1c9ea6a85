// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace stillhand::runtime {

/// A UDP socket to one other side, non-blocking.  One thread.
class UdpSocket {
 public:
  /// @param local_port  0: any that is free
  /// @throws ConfigError for an address that is none, or a local port that is taken
  UdpSocket(const std::string& address, std::uint16_t port, std::uint16_t local_port);
  ~UdpSocket();
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;

  [[nodiscard]] int descriptor() const noexcept { return descriptor_; }
  /// One datagram of the other side; empty if none is there.
  std::span<const std::uint8_t> receive(std::span<std::uint8_t> into) noexcept;
  /// @returns false if the kernel did not take it
  bool send(std::span<const std::uint8_t> datagram) noexcept;

 private:
  int descriptor_ = -1;
};

}  // namespace stillhand::runtime

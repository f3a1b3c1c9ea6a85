// SPDX-License-Identifier: Apache-2.0
#include "services/system/transport/udp_socket.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {
namespace {

sockaddr_in place(std::uint16_t port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  return address;
}

bool joins(int descriptor, const sockaddr_in& here, const sockaddr_in& there) {
  // sockaddr is how the socket calls name every kind of address.
  return bind(descriptor, reinterpret_cast<const sockaddr*>(&here), sizeof(here)) == 0 &&
         connect(descriptor, reinterpret_cast<const sockaddr*>(&there), sizeof(there)) == 0;
}

}  // namespace

UdpSocket::UdpSocket(const std::string& address, std::uint16_t port, std::uint16_t local_port) {
  sockaddr_in there = place(port);
  if (inet_pton(AF_INET, address.c_str(), &there.sin_addr) != 1) {
    throw ConfigError("UDP address", address, "an IPv4 address such as 192.168.1.20");
  }
  descriptor_ = socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor_ < 0 || !joins(descriptor_, place(local_port), there)) {
    const std::string why = std::generic_category().message(errno);
    if (descriptor_ >= 0) close(descriptor_);
    throw ConfigError("UDP port " + std::to_string(local_port) + " to " + address, why,
                      "a port that is free");
  }
}

UdpSocket::~UdpSocket() { close(descriptor_); }

std::span<const std::uint8_t> UdpSocket::receive(std::span<std::uint8_t> into) noexcept {
  const ssize_t count = recv(descriptor_, into.data(), into.size(), 0);
  if (count <= 0) return {};
  return into.first(static_cast<std::size_t>(count));
}

bool UdpSocket::send(std::span<const std::uint8_t> datagram) noexcept {
  return ::send(descriptor_, datagram.data(), datagram.size(), 0) ==
         static_cast<ssize_t>(datagram.size());
}

}  // namespace stillhand::runtime

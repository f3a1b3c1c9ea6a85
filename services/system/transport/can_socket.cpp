// SPDX-License-Identifier: Apache-2.0
#include "services/system/transport/can_socket.hpp"

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {
namespace {

[[noreturn]] void refuse_can(const std::string& interface, const std::string& why,
                             const std::string& want) {
  throw ConfigError("CAN interface " + interface, why, want);
}

std::string can_error() { return std::generic_category().message(errno); }

}  // namespace

CanSocket::CanSocket(const std::string& interface) {
  try {
    open(interface);
  } catch (...) {
    close();
    throw;
  }
}

CanSocket::~CanSocket() { close(); }

void CanSocket::open(const std::string& interface) {
  constexpr std::size_t kMostName = IFNAMSIZ - 1;
  if (interface.empty() || interface.size() > kMostName) {
    refuse_can(interface, "no name of an interface",
               "one that `ip link show type can` shows, can0");
  }
  descriptor_ = socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW);
  if (descriptor_ < 0) {
    refuse_can(
        interface, "a kernel without CAN: " + can_error(),
        "one with can_raw (modprobe can_raw), or drive.kind moteus and the adapter's serial port");
  }
  ifreq request{};
  std::ranges::copy(interface, request.ifr_name);
  if (ioctl(descriptor_, SIOCGIFINDEX, &request) != 0) {
    refuse_can(interface, can_error(), "an interface that `ip link show type can` shows");
  }
  const int index = request.ifr_ifindex;
  if (ioctl(descriptor_, SIOCGIFFLAGS, &request) != 0 || (request.ifr_flags & IFF_UP) == 0) {
    refuse_can(interface, "an interface that is down",
               "one that is up: ip link set " + interface +
                   " up type can bitrate 1000000 dbitrate "
                   "5000000 fd on");
  }
  if (ioctl(descriptor_, SIOCGIFMTU, &request) != 0 ||
      request.ifr_mtu < static_cast<int>(CANFD_MTU)) {
    refuse_can(interface, "an interface without CAN-FD", "fd on, in its `ip link set`");
  }
  lock_.emplace(interface, "CAN interface " + interface, "an interface that another process has",
                "one for this session alone");
  const int on = 1;
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = index;
  if (setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) != 0 ||
      bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    refuse_can(interface, can_error(), "a CAN-FD interface");
  }
}

void CanSocket::close() noexcept {
  lock_.reset();
  if (descriptor_ >= 0) ::close(descriptor_);
  descriptor_ = -1;
}

std::string_view CanSocket::read(std::span<char> into) noexcept {
  const ssize_t count = ::read(descriptor_, into.data(), into.size());
  if (count > 0) return {into.data(), static_cast<std::size_t>(count)};
  if (errno != EAGAIN && errno != EINTR) gone_ = true;
  return {};
}

bool CanSocket::write(std::string_view bytes) noexcept {
  const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
  // A full queue of the interface is no reason to give it up.
  if (count < 0 && errno != EAGAIN && errno != EINTR && errno != ENOBUFS) gone_ = true;
  return count == static_cast<ssize_t>(bytes.size());
}

}  // namespace stillhand::runtime

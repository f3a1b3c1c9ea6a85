// SPDX-License-Identifier: Apache-2.0
#include "services/system/process/host_lock.hpp"

#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <system_error>

#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {

HostLock::HostLock(const std::string& name, const std::string& what, const std::string& got,
                   const std::string& want)
    : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
  const std::string whole = "stillhand-" + name;
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  const std::size_t copied = whole.copy(address.sun_path + 1, sizeof(address.sun_path) - 1);
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + copied);
  // sockaddr is how the socket calls name every kind of address.
  if (socket_ >= 0 && bind(socket_, reinterpret_cast<const sockaddr*>(&address), size) == 0) return;
  const int error = errno;
  if (socket_ >= 0) close(socket_);
  if (error == EADDRINUSE) throw ConfigError(what, got, want);
  throw ConfigError(what, "no lock: " + std::generic_category().message(error),
                    "a socket of this machine");
}

HostLock::~HostLock() { close(socket_); }

}  // namespace stillhand::runtime

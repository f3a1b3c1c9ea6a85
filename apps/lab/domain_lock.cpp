// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/domain_lock.hpp"

#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "services/core/contract/config_error.hpp"
#include "services/system/process/domain.hpp"

namespace stillhand::lab {
namespace {

void check_port(std::uint32_t domain) {
  const auto port = static_cast<std::uint16_t>(runtime::first_port_of(domain));
  const int probe = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  const int shared = 1;  // as Fast DDS opens it: other participants do not count
  setsockopt(probe, SOL_SOCKET, SO_REUSEADDR, &shared, sizeof(shared));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  const bool taken = bind(probe, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0;
  close(probe);
  if (taken) {
    throw ConfigError("--domain",
                      fmt::format("{}, whose UDP port {} another program holds", domain, port),
                      "a domain whose port 7400 + 250 * domain is free");
  }
}

}  // namespace

DomainLock::DomainLock(std::uint32_t domain, std::uint32_t rig)
    : lock_(fmt::format("lab-{}-{}", domain, rig), "--domain",
            fmt::format("{}, where another lab runs", domain),
            "a free DDS domain, or another --rig") {
  check_port(domain);
}

}  // namespace stillhand::lab

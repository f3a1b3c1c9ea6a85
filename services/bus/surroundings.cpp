// SPDX-License-Identifier: Apache-2.0
#include "services/bus/surroundings.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>

#include <cstdlib>
#include <map>
#include <memory>
#include <string>

namespace stillhand::runtime {
namespace {

// Each interface's name and flags by its IPv4 address.
std::map<std::string, std::pair<std::string, unsigned>> interfaces() {
  std::map<std::string, std::pair<std::string, unsigned>> found;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return found;
  const std::unique_ptr<ifaddrs, decltype(&freeifaddrs)> owner(list, &freeifaddrs);
  for (const ifaddrs* each = list; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr == nullptr || each->ifa_addr->sa_family != AF_INET) continue;
    char text[INET_ADDRSTRLEN]{};
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(each->ifa_addr)->sin_addr, text,
              sizeof(text));
    found[text] = {each->ifa_name, each->ifa_flags};
  }
  return found;
}

void check_environment(const edds::DomainParticipantQos& qos) {
  // Fast DDS reads them only for a participant without a server of its own.
  if (qos.wire_protocol().builtin.discovery_config.discoveryProtocol !=
      ertps::DiscoveryProtocol::SIMPLE) {
    return;
  }
  for (const char* name : {"ROS_DISCOVERY_SERVER", "FASTDDS_ENVIRONMENT_FILE"}) {
    // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing here sets a variable
    const char* value = std::getenv(name);
    if (value == nullptr || *value == '\0') continue;
    throw ConfigError(fmt::format("environment variable {}", name), value,
                      "none: Fast DDS would look for a discovery server and find no process of "
                      "the session (`unset " +
                          std::string(name) + "`)");
  }
}

void check_addresses(const edds::DomainParticipantQos& qos, const std::string& where) {
  const auto own = interfaces();
  for (const auto& transport : qos.transport().user_transports) {
    const auto* udp = dynamic_cast<const ertps::UDPv4TransportDescriptor*>(transport.get());
    if (udp == nullptr) continue;
    for (const std::string& address : udp->interfaceWhiteList) {
      // A lo that is down keeps its address to itself: the list does not have it.
      const auto found = own.find(address);
      if (found != own.end() && (found->second.second & IFF_UP) != 0U) continue;
      throw ConfigError(where,
                        found == own.end()
                            ? address + ", which no interface of this machine has"
                            : address + " of " + found->second.first + ", which is down",
                        "the address of an interface that is up (`ip address`)");
    }
  }
}

}  // namespace

void check_surroundings(const edds::DomainParticipantQos& qos, const std::string& where) {
  check_environment(qos);
  check_addresses(qos, where);
}

}  // namespace stillhand::runtime

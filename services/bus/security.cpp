// SPDX-License-Identifier: Apache-2.0
#include "services/bus/security.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <memory>
#include <optional>

#include "fast_dds/names.hpp"
#include "services/core/contract/config_error.hpp"

namespace stillhand::runtime {
namespace {

namespace fs = std::filesystem;

/// The only address by which a participant of this profile hears others, "" for that of any
/// interface; nothing where there may be several, each with a thread of its own.
std::optional<std::string> only_address(const edds::DomainParticipantQos& qos) {
  const auto& transports = qos.transport().user_transports;
  if (qos.transport().use_builtin_transports || transports.size() != 1) return std::nullopt;
  const auto udp = std::dynamic_pointer_cast<ertps::UDPv4TransportDescriptor>(transports.front());
  if (udp == nullptr || udp->interfaceWhiteList.size() > 1) return std::nullopt;
  return udp->interfaceWhiteList.empty() ? "" : udp->interfaceWhiteList.front();
}

// Fast DDS 2.9.1 prepares what a handshake goes through without a lock, in the thread that hears of
// a participant first (SecurityManager::match_builtin_endpoints, a race mended after it by pull
// request 4188).  A multicast group and a unicast port are two threads: they mix up two
// participants, with which no handshake ever comes to an end (qos/README.md, "What security
// costs").  So only one thread may hear.
void discover_in_one_thread(edds::DomainParticipantQos& qos) {
  constexpr const char* kLoopback = "127.0.0.1";
  const std::optional<std::string> address = only_address(qos);
  if (!address) {
    throw ConfigError("security", "a participant profile with several transports or addresses",
                      "one transport, UDPv4, with at most one address in its interfaceWhiteList");
  }
  auto& builtin = qos.wire_protocol().builtin;
  const bool group = !builtin.metatrafficMulticastLocatorList.empty();
  // Without a group of the profile's own, a unicast list means that there is none.
  if (!builtin.metatrafficUnicastLocatorList.empty() && !group) return;
  if (group || *address != kLoopback) {
    throw ConfigError(
        "security", "discovery by multicast in the participant profile",
        "only initial peers and a metatrafficUnicastLocatorList, as `stillhand deploy "
        "generate` writes them");
  }
  builtin.metatrafficUnicastLocatorList.push_back(
      ertps::Locator_t());  // the port that the standard names
  ertps::Locator_t peers;   // of the first maxInitialPeersRange participants
  ertps::IPLocator::setIPv4(peers, kLoopback);
  builtin.initialPeersList.push_back(peers);
}

}  // namespace

void secure(edds::DomainParticipantQos& qos, const Identity& identity) {
  if (qos.wire_protocol().builtin.discovery_config.discoveryProtocol !=
      ertps::DiscoveryProtocol::SIMPLE) {
    throw ConfigError("security", "a discovery server in the participant profile",
                      "initial peers: a discovery server would admit strangers");
  }
  discover_in_one_thread(qos);
  const auto set = [&qos](const std::string& name, const std::string& value) {
    qos.properties().properties().emplace_back(name, value);
  };
  const auto set_file = [&set](const std::string& name, const fs::path& file) {
    set(name, "file://" + file.string());
  };
  const std::string authentication = "dds.sec.auth.builtin.PKI-DH.";
  set("dds.sec.auth.plugin", "builtin.PKI-DH");
  set_file(authentication + "identity_ca", identity.authority_file());
  set_file(authentication + "identity_certificate", identity.own_file("certificate.pem"));
  set_file(authentication + "private_key", identity.own_file("key.pem"));
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  set("dds.sec.access.plugin", "builtin.Access-Permissions");
  set_file(access + "permissions_ca", identity.authority_file());
  set_file(access + "governance", identity.governance_file());
  set_file(access + "permissions", identity.own_file("permissions.p7s"));
  set("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

bool is_secured(const edds::DomainParticipant& participant, const Identity& identity) {
  const auto expected = guid_start(identity);
  const ertps::GUID_t& guid = participant.guid();
  return std::equal(expected.begin(), expected.end(), std::begin(guid.guidPrefix.value));
}

}  // namespace stillhand::runtime

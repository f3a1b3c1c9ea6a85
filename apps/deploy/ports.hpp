// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "services/system/process/domain.hpp"

namespace stillhand::deploy {

struct Inventory;

/// UDP ports of a DDS domain within its block (runtime/domain.hpp).
///
///   multicast, discovery   7400 + 250 domain          user data   + 1
///   participant p, discovery  + 10 + 2 p              user data   + 11 + 2 p
struct DomainPorts {
  explicit constexpr DomainPorts(std::uint32_t domain) : first(runtime::first_port_of(domain)) {}

  [[nodiscard]] constexpr std::uint32_t multicast() const { return first; }
  /// Port of the discovery server; the standard uses no such port of the block.
  [[nodiscard]] constexpr std::uint32_t server() const { return first + 2; }
  /// Last port of a host with `participants`.
  [[nodiscard]] constexpr std::uint32_t last(std::uint32_t participants) const {
    return first + 11 + 2 * (participants - 1);
  }
  /// Most participants of one host whose ports stay below the next domain's.
  static constexpr std::uint32_t kMostParticipants = (runtime::kDomainPorts - 10) / 2;

  std::uint32_t first;
};

/// Participants of a host in addition to its services: tools (`stillhand record` takes two), and
/// processes whose predecessor still holds its port.
inline constexpr std::size_t kToolsOnAHost = 7;
inline constexpr std::size_t kMostServicesOnAHost = DomainPorts::kMostParticipants - kToolsOnAHost;

/// Number of participants that discovery looks for on each host: the services of the fullest host
/// and kToolsOnAHost, at least 16.
std::uint32_t participants_sought(const Inventory& inventory);

}  // namespace stillhand::deploy

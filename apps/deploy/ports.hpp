// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>

#include "services/runtime/process/domain.hpp"

namespace stillhand::deploy {

struct Inventory;

/// UDP ports of a DDS domain within its block (runtime/domain.hpp).
///
///   multicast, discovery   7400 + 250 domain          user data   + 1
///   participant p, discovery  + 10 + 2 p              user data   + 11 + 2 p
struct DomainPorts {
  explicit constexpr DomainPorts(std::uint32_t domain) : first(runtime::first_port_of(domain)) {}

  [[nodiscard]] constexpr std::uint32_t multicast() const { return first; }
  /// Of the discovery server: none of the block's ports that the standard uses.
  [[nodiscard]] constexpr std::uint32_t server() const { return first + 2; }
  /// Last port of a host with `participants`.
  [[nodiscard]] constexpr std::uint32_t last(std::uint32_t participants) const {
    return first + 11 + 2 * (participants - 1);
  }
  /// Of one host, before their ports would be the next domain's.
  static constexpr std::uint32_t kMostParticipants = (runtime::kDomainPorts - 10) / 2;

  std::uint32_t first;
};

/// Places beside the services' for tools (`stillhand record` takes two) and for processes whose
/// predecessor still holds its port.
inline constexpr std::size_t kToolsOnAHost = 7;
inline constexpr std::size_t kMostServicesOnAHost = DomainPorts::kMostParticipants - kToolsOnAHost;

/// How many participants of one host are looked for: what the fullest runs and kToolsOnAHost; 16 at
/// least.
std::uint32_t participants_sought(const Inventory& inventory);

}  // namespace stillhand::deploy

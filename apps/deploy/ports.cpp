// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/ports.hpp"

#include <algorithm>

#include "apps/deploy/inventory.hpp"

namespace stillhand::deploy {

std::uint32_t participants_sought(const Inventory& inventory) {
  std::size_t most = 16;
  for (const Host& host : inventory.hosts) {
    most = std::max(most, host.services.size() + kToolsOnAHost);
  }
  return static_cast<std::uint32_t>(most);
}

}  // namespace stillhand::deploy

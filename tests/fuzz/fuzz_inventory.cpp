// SPDX-License-Identifier: Apache-2.0
// The inventory of a lab.  One that is read has its files generated as well.
#include <string>

#include "apps/deploy/inventory.hpp"
#include "services/core/contract/config_error.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace stillhand;
  try {
    const auto inventory = deploy::parse_inventory(
        std::string(reinterpret_cast<const char*>(bytes), size), "inventory.yaml");
    for (const auto& rig : inventory.rigs) {
      for (const auto* service : {"rig", "recorder", "experiment"}) {
        static_cast<void>(inventory.host_of(service, rig.number));
      }
    }
  } catch (const ConfigError&) {
    return 0;
  }
  return 0;
}

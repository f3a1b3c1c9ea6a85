// SPDX-License-Identifier: Apache-2.0
// Inventories for tests, in folders that go with them.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <string>
#include <string_view>

#include "apps/deploy/inventory.hpp"
#include "idl/topics.hpp"
#include "tests/support/folder.hpp"

namespace stillhand::deploy {

/// Every process but those, as an inventory lists them.
inline std::string all_but(std::initializer_list<std::string_view> others) {
  std::string list;
  for (const std::string_view service : topics::kServices) {
    if (std::ranges::find(others, service) != others.end()) continue;
    list += (list.empty() ? "" : ", ") + std::string(service);
  }
  return list;
}
inline const std::string kAllServices = all_but({});

/// A folder of its own for a test.
class SampleFolder : public support::Folder {
 public:
  /// An inventory of that text.
  [[nodiscard]] std::filesystem::path file(const std::string& text) const {
    std::filesystem::path file = path() / "inventory.yaml";
    std::ofstream(file) << text;
    return file;
  }
};

inline Inventory sample_inventory(const std::string& text) {
  const SampleFolder folder;
  return read_inventory(folder.file(text));
}

/// Rig 1 "left" on host "one", rig 7 "right" on host "two", and a host that only watches.
inline std::string two_rigs() {
  const auto all = [](const std::string& rig) {
    std::string list;
    for (const auto service : topics::kServices) {
      list += (list.empty() ? "" : ", ") + std::string("{service: ") + std::string(service) +
              ", rig: " + rig + "}";
    }
    return "[" + list + "]";
  };
  return "lab: pair\ndomain: 3\nsecurity: none\nrigs: [{name: left, number: 1}, {name: right, "
         "number: 7}]\n"
         "hosts:\n"
         "  - {name: one, address: 10.0.0.1, start: [ssh, one], services: " +
         all("left") +
         "}\n"
         "  - {name: two, address: 10.0.0.2, start: [ssh, two], services: " +
         all("right") +
         "}\n"
         "  - {name: watcher, address: 10.0.0.3}\n";
}

}  // namespace stillhand::deploy

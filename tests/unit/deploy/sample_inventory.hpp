// SPDX-License-Identifier: Apache-2.0
// Inventories for tests, in folders that go with them.
#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "apps/deploy/inventory.hpp"
#include "idl/topics.hpp"

namespace stillhand::deploy {

inline const std::string kAllServices =
    "motion, rig, sensing, cancellation, display, human_operator, identification, recorder, "
    "experiment";

/// A folder of its own for a test.
class SampleFolder {
 public:
  SampleFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "stillhand-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error(name);
    path_ = name;
  }
  ~SampleFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  SampleFolder(const SampleFolder&) = delete;
  SampleFolder& operator=(const SampleFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// An inventory of that text.
  [[nodiscard]] std::filesystem::path file(const std::string& text) const {
    std::filesystem::path file = path_ / "inventory.yaml";
    std::ofstream(file) << text;
    return file;
  }

 private:
  std::filesystem::path path_;
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

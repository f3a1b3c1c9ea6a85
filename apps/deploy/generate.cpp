// SPDX-License-Identifier: Apache-2.0
#include "deploy/generate.hpp"

#include <algorithm>
#include <list>

#include "deploy/host_files.hpp"
#include "recording/file_io.hpp"
#include "report/staged_folder.hpp"

namespace stillhand::deploy {
namespace {

namespace fs = std::filesystem;

// Files of a folder that an earlier run made, by their mark.
std::vector<std::string> made_before(const fs::path& folder) {
  std::vector<std::string> names;
  if (!fs::is_directory(folder)) return names;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    if (recording::read_file(entry.path().string()).find(kGeneratedMark) == std::string::npos) {
      continue;
    }
    names.push_back(entry.path().filename().string());
  }
  return names;
}

std::vector<fs::path> folders_of_nobody(const Inventory& inventory, const fs::path& out) {
  std::vector<fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(out)) {
    if (!entry.is_directory() || made_before(entry.path()).empty()) continue;
    if (inventory.find_host(entry.path().filename().string()) == nullptr) {
      found.push_back(entry.path());
    }
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace

std::vector<GeneratedFile> files_of(const Inventory& inventory, const Host& host,
                                    const LabProfiles& profiles) {
  std::vector<GeneratedFile> files{{"profiles.xml", profiles.of(inventory, host)}};
  if (inventory.discovery == Discovery::kServer && &host == &inventory.hosts.front()) {
    files.push_back({"discovery_server.xml", profiles.of_server(inventory)});
  }
  std::ranges::move(units_of(inventory, host), std::back_inserter(files));
  files.push_back(firewall_of(inventory, host));
  files.push_back(sysctl_of(inventory, host, profiles.buffers()));
  return files;
}

std::vector<fs::path> generate(const Inventory& inventory, const LabProfiles& profiles,
                               const fs::path& out) {
  // The outer one holds the lock, and takes back a folder that it made.
  report::StagedFolder whole(out);
  std::list<report::StagedFolder> folders;
  for (const Host& host : inventory.hosts) {
    const report::StagedFolder& folder = folders.emplace_back(out / host.name);
    for (const GeneratedFile& file : files_of(inventory, host, profiles)) {
      folder.write(file.name, file.text);
    }
  }
  auto host = inventory.hosts.begin();
  for (report::StagedFolder& folder : folders) folder.publish(made_before(out / (host++)->name));
  whole.publish({});
  return folders_of_nobody(inventory, out);
}

}  // namespace stillhand::deploy

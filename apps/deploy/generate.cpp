// SPDX-License-Identifier: Apache-2.0
#include "apps/deploy/generate.hpp"

#include <algorithm>
#include <fstream>
#include <list>

#include "apps/deploy/host_files.hpp"
#include "apps/libraries/report/staged_folder.hpp"

namespace stillhand::deploy {
namespace {

namespace fs = std::filesystem;

// True if the mark is in the first bytes.  A file that cannot be read counts as not generated.
bool is_generated(const fs::path& file) {
  constexpr std::streamsize kHead = 4096;
  std::string head(static_cast<std::size_t>(kHead), '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(head.data(), kHead);
  return head.find(kGeneratedMark) != std::string::npos;
}

// Files of a folder that an earlier run generated.
std::vector<std::string> made_before(const fs::path& folder) {
  std::vector<std::string> names;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
    if (!entry.is_regular_file(unreadable) || !is_generated(entry.path())) continue;
    names.push_back(entry.path().filename().string());
  }
  return names;
}

std::vector<fs::path> folders_without_host(const Inventory& inventory, const fs::path& out) {
  std::vector<fs::path> found;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(out, unreadable)) {
    if (!entry.is_directory(unreadable) || made_before(entry.path()).empty()) continue;
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
  if (auto rules = device_rules_of(inventory, host)) files.push_back(std::move(*rules));
  if (auto iiod = iiod_priority_of(inventory, host)) files.push_back(std::move(*iiod));
  return files;
}

std::vector<fs::path> generate(const Inventory& inventory, const LabProfiles& profiles,
                               const fs::path& wanted) {
  const fs::path out = fs::weakly_canonical(wanted);
  // The outer folder holds the lock, and is removed again if this run made it and fails.
  report::StagedFolder whole(out);
  std::list<report::StagedFolder> folders;
  for (const Host& host : inventory.hosts) {
    const report::StagedFolder& folder = folders.emplace_back(out / host.name);
    for (const GeneratedFile& file : files_of(inventory, host, profiles)) {
      folder.write(file.name, file.text);
    }
  }
  for (const report::StagedFolder& folder : folders) folder.check();
  auto host = inventory.hosts.begin();
  for (report::StagedFolder& folder : folders) folder.publish(made_before(out / (host++)->name));
  whole.publish({});
  return folders_without_host(inventory, out);
}

}  // namespace stillhand::deploy

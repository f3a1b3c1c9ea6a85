// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "apps/deploy/inventory.hpp"
#include "apps/lab/processes.hpp"
#include "apps/lab/remote.hpp"

namespace stillhand::lab {

struct LabOptions;

/// Where a service reads its files and writes its own.
struct Place {
  std::filesystem::path profiles;
  std::filesystem::path config;
  std::filesystem::path out;
  std::filesystem::path security;  ///< folder of keys; empty: none
};

/// The machines of a session: this one alone, or those of an inventory.  One thread.
class Hosts {
 public:
  /// Reads the inventory, if one is given.
  /// @throws ConfigError for an inventory that is wrong or does not fit the options
  explicit Hosts(const LabOptions& options);
  ~Hosts() { clear(); }
  Hosts(const Hosts&) = delete;
  Hosts& operator=(const Hosts&) = delete;

  /// DDS domain of the session.
  [[nodiscard]] std::uint32_t domain() const noexcept { return domain_; }
  /// Makes a folder on every other host, and gives it profiles and settings.
  /// @throws ConfigError when a host cannot be reached, Interrupted on a stop meanwhile
  void open(const runtime::Stop& stop);
  [[nodiscard]] Place of(std::string_view service) const;
  /// The process as it is started from here, on the host of its service.
  [[nodiscard]] Launch placed(const Launch& local) const;
  /// Copies the files that services wrote on other hosts into the folder of the session, and clears
  /// those hosts.  Reports on standard error which files it could not copy.
  void bring_back() noexcept;
  /// The same for a recorder that ran already.  @param file  path that it reported
  void bring_recording(const std::filesystem::path& file) noexcept;
  /// Removes from the hosts what bring_back() did not.
  void clear() noexcept;

 private:
  [[nodiscard]] const deploy::Host* host_of(std::string_view service) const;
  [[nodiscard]] RemoteHost* remote_of(std::string_view service) const;
  void check(const LabOptions& options) const;
  /// Services of the session on a host; nullptr: all.
  [[nodiscard]] std::vector<std::string> services_on(const deploy::Host* host) const;

  std::optional<deploy::Inventory> inventory_;
  std::uint32_t domain_;
  std::uint32_t rig_;
  Place local_;
  bool video_, attach_;
  std::map<const deploy::Host*, std::unique_ptr<RemoteHost>> remotes_;
};

}  // namespace stillhand::lab

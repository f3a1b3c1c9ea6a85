// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "apps/deploy/inventory.hpp"

namespace stillhand::deploy {

/// Socket buffers that a profile asks for [bytes]; 0: the system's default.
struct Buffers {
  std::uint64_t send = 0;
  std::uint64_t receive = 0;
};

/// Fast DDS profiles of one lab, made from qos/profiles.xml: the patterns as they are there, with a
/// transport on the host's own address and the lab's discovery.
class LabProfiles {
 public:
  /// @param base  qos/profiles.xml  @throws ConfigError when it isn't as this program knows it
  explicit LabProfiles(const std::filesystem::path& base);

  /// profiles.xml of a host, for every process there.
  [[nodiscard]] std::string of(const Inventory& inventory, const Host& host) const;
  /// Of the discovery server, Discovery::kServer only: `fast-discovery-server -x`.
  [[nodiscard]] std::string of_server(const Inventory& inventory) const;
  [[nodiscard]] const Buffers& buffers() const noexcept { return buffers_; }

 private:
  std::filesystem::path file_;
  std::string base_;
  Buffers buffers_;
};

}  // namespace stillhand::deploy

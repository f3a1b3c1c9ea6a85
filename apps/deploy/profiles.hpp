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

/// Fast DDS profiles of one lab, made from qos/profiles.xml.  The patterns stay unchanged; the
/// transport uses the host's own address, and the discovery is the lab's.
class LabProfiles {
 public:
  /// @param base  qos/profiles.xml
  /// @throws ConfigError when it lacks an element that this class replaces
  explicit LabProfiles(const std::filesystem::path& base);

  /// profiles.xml of a host, for every process there.
  [[nodiscard]] std::string of(const Inventory& inventory, const Host& host) const;
  /// Profiles of the discovery server (`fast-discovery-server -x`), Discovery::kServer only.
  [[nodiscard]] std::string of_server(const Inventory& inventory) const;
  [[nodiscard]] const Buffers& buffers() const noexcept { return buffers_; }

 private:
  std::filesystem::path file_;
  std::string base_;
  Buffers buffers_;
};

}  // namespace stillhand::deploy

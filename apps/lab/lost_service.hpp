// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/lab/processes.hpp"
#include "services/bus/bus.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::lab {

/// Looks for a service whose life sign is gone for good: the service hangs, or it ended and is no
/// child of this process.  One thread.
class LostService {
 public:
  /// @param patience_s  [s] how long a life sign may be absent
  /// @param only        the service to look for; empty: every service
  LostService(const runtime::Bus& bus, double patience_s, std::string only = "")
      : bus_(bus),
        patience_ns_(static_cast<std::int64_t>(patience_s * 1e9)),
        only_(std::move(only)) {}

  std::optional<Ended> operator()() {
    std::vector<std::string> lost = bus_.lost_peers();
    std::erase_if(lost, [&](const std::string& name) { return !only_.empty() && name != only_; });
    const std::int64_t now_ns = runtime::monotonic_ns();
    if (lost.empty()) since_ns_ = now_ns;
    if (now_ns - since_ns_ < patience_ns_) return std::nullopt;
    return Ended{lost.front(), 0, "its life sign is gone", -1, ""};
  }

 private:
  const runtime::Bus& bus_;
  std::int64_t patience_ns_;
  std::string only_;
  std::int64_t since_ns_ = runtime::monotonic_ns();
};

}  // namespace stillhand::lab

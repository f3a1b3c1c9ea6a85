// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <vector>

namespace stillhand::benchmark {

/// Median, tail and worst of latencies [ns], in microseconds.
inline nlohmann::json figures(std::vector<std::int64_t> latencies_ns) {
  if (latencies_ns.empty()) return {{"samples", 0}};
  std::ranges::sort(latencies_ns);
  const auto at = [&](double share) {
    const auto index = static_cast<std::size_t>(share * static_cast<double>(latencies_ns.size()));
    return static_cast<double>(latencies_ns[std::min(index, latencies_ns.size() - 1)]) * 1e-3;
  };
  return {{"samples", latencies_ns.size()},
          {"p50", at(0.5)},
          {"p99", at(0.99)},
          {"p999", at(0.999)},
          {"worst", at(1.0)}};
}

}  // namespace stillhand::benchmark

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>

namespace stillhand::signal {

/// Samples that share one rotation where lines are added to a record, or taken from it: near the
/// square root of the record the fewest sines are computed.
inline std::size_t rotation_block(std::size_t samples) {
  return static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(samples))));
}

}  // namespace stillhand::signal

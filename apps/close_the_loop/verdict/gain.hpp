// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

namespace stillhand::close_the_loop {

/// Whether a model that takes more work than another one is worth it, METHOD Eq. CL-10.
/// @param saved       what it leaves less than the other
/// @param interval95  of it; none: too little was measured for one, and the mean decides
inline bool is_gain(double saved, const std::optional<std::pair<double, double>>& interval95) {
  return saved > 0.0 && (!interval95 || interval95->first > 0.0);
}

}  // namespace stillhand::close_the_loop

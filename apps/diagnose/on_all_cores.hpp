// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace stillhand::diagnose {

/// task(0) to task(count - 1) on every core at once, for diagnosis::ForEach; the first exception is
/// thrown again here.
void on_all_cores(std::size_t count, const std::function<void(std::size_t)>& task);

}  // namespace stillhand::diagnose

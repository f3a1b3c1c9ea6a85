// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/rest.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace stillhand::lab {

Actions Rest::step(Seen& seen, std::int64_t now_ns) {
  if (limit_ns_ < 0) {
    limit_ns_ = now_ns + static_cast<std::int64_t>(1e9 * seconds_);
    starts_ = seen.requests.starts();
  }
  Actions actions;
  const bool ended = is_there_ ? is_there_() : seen.requests.starts() != starts_;
  const bool over = now_ns >= limit_ns_ || ended;
  if (trouble_.wait(over, seen, limit_ns_ + 1, now_ns) != Wait::kGoesOn) {
    finish();
    return actions;
  }
  const double left_s = 1e-9 * static_cast<double>(std::max<std::int64_t>(limit_ns_ - now_ns, 0));
  actions.progress = {fmt::format("{}, {:.0f} s left", what_, left_s),
                      seconds_ > 0.0 ? 1.0 - left_s / seconds_ : 1.0};
  return actions;
}

}  // namespace stillhand::lab

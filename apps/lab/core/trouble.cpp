// SPDX-License-Identifier: Apache-2.0
#include "apps/lab/core/trouble.hpp"

#include <utility>

namespace stillhand::lab {

void Trouble::look(Seen& seen, std::int64_t now_ns) {
  constexpr std::int64_t kSettle_ns = 50'000'000;
  if (why_.empty()) why_ = seen.requests.emergency();
  if (!seen.ended) return;
  if (!since_ns_) since_ns_ = now_ns;
  if (now_ns - *since_ns_ < kSettle_ns) return;
  since_ns_.reset();
  const Death death = *std::exchange(seen.ended, std::nullopt);
  if (seen.interrupted) return;
  why_ = death.line;
  refused_ = death.refused;
  silent_ = death.silent;
}

Wait Trouble::wait(bool over, Seen& seen, std::int64_t limit_ns, std::int64_t now_ns) {
  if (over && !settles()) return Wait::kOver;
  look(seen, now_ns);
  if (settles()) return Wait::kGoesOn;
  if (!why_.empty() || seen.interrupted) return Wait::kStopped;
  return now_ns > limit_ns ? Wait::kTooLong : Wait::kGoesOn;
}

std::string Trouble::why_stopped(const Seen& seen, const std::string& otherwise) const {
  if (!why_.empty()) return why_;
  return seen.interrupted ? "interrupted" : otherwise;
}

}  // namespace stillhand::lab

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace stillhand {

/// a - b [ns] of two times that somebody else wrote, within 30 years: whatever they are, what is
/// computed on with it does not overflow.  Pure.
inline std::int64_t difference_ns(std::int64_t a_ns, std::int64_t b_ns) noexcept {
  constexpr std::int64_t kMost_ns = 1'000'000'000'000'000'000;
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a_ns, b_ns, &difference)) return a_ns < b_ns ? -kMost_ns : kMost_ns;
  return std::clamp(difference, -kMost_ns, kMost_ns);
}

}  // namespace stillhand

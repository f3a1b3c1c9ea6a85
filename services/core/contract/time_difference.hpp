// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace stillhand {

/// a - b [ns] of two received times, clipped to about 30 years: further computation with the result
/// does not overflow, for any received values.  Pure.
inline std::int64_t difference_ns(std::int64_t a_ns, std::int64_t b_ns) noexcept {
  constexpr std::int64_t kMost_ns = 1'000'000'000'000'000'000;
  std::int64_t difference = 0;
  if (__builtin_sub_overflow(a_ns, b_ns, &difference)) return a_ns < b_ns ? -kMost_ns : kMost_ns;
  return std::clamp(difference, -kMost_ns, kMost_ns);
}

}  // namespace stillhand

// SPDX-License-Identifier: Apache-2.0
#include "tests/emulators/indicator_side.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace stillhand::emulators {

std::string indicator_line(double force_n, bool overload) {
  constexpr double kNewtonsPerGram = 0.00980665;
  constexpr double kMost_g = 9000.0;
  const double grams = force_n / kNewtonsPerGram;
  const bool beyond = overload || !(std::abs(grams) <= kMost_g);
  std::array<char, 40> line{};
  std::snprintf(line.data(), line.size(), "N,%+09.3f,g,%s\r\n", beyond ? 0.0 : grams,
                beyond ? "OL" : "US");
  return line.data();
}

void IndicatorSide::step(double force_n, std::int64_t now_ns) {
  if (steps_++ % 2 == 0) serial_.write(indicator_line(force_n, overload_), now_ns);
  serial_.send_due(now_ns);
}

}  // namespace stillhand::emulators

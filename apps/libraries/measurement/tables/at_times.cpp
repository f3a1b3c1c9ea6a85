// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/tables/at_times.hpp"

#include <cmath>
#include <limits>

#include "services/core/signal/moments.hpp"

namespace stillhand::measurement {
namespace {

// Lagrange's polynomial through the rows [first, end).
double through(const std::vector<double>& time_s, const std::vector<double>& values,
               std::size_t first, std::size_t end, double wanted_s) {
  double sum = 0.0;
  for (std::size_t i = first; i < end; ++i) {
    double weight = 1.0;
    for (std::size_t j = first; j < end; ++j) {
      if (j != i) weight *= (wanted_s - time_s[j]) / (time_s[i] - time_s[j]);
    }
    sum += weight * values[i];
  }
  return sum;
}

}  // namespace

std::vector<double> at_times(const std::vector<double>& time_s, const std::vector<double>& values,
                             const std::vector<double>& wanted_s, double longest_s) {
  std::vector<double> out;
  out.reserve(wanted_s.size());
  std::size_t next = 0;  // first row behind the time
  for (const double t : wanted_s) {
    while (next < time_s.size() && time_s[next] <= t) ++next;
    const bool before = next == 0;
    if (!before && time_s[next - 1] == t) {
      out.push_back(values[next - 1]);
      continue;
    }
    if (before || next == time_s.size() || time_s[next] - time_s[next - 1] > longest_s) {
      out.push_back(std::numeric_limits<double>::quiet_NaN());
      continue;
    }
    // A row beyond a gap would bend the cubic.
    std::size_t first = next - 1;
    std::size_t end = next + 1;
    if (first > 0 && time_s[first] - time_s[first - 1] <= longest_s) --first;
    if (end < time_s.size() && time_s[end] - time_s[end - 1] <= longest_s) ++end;
    out.push_back(through(time_s, values, first, end, t));
  }
  return out;
}

double longest_bridge_s(const std::vector<double>& time_s) {
  constexpr double kSteps = 4.0;
  std::vector<double> steps_s;
  for (std::size_t i = 1; i < time_s.size(); ++i) steps_s.push_back(time_s[i] - time_s[i - 1]);
  return kSteps * signal::middle_of(steps_s);
}

}  // namespace stillhand::measurement

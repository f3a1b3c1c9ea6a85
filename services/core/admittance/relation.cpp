// SPDX-License-Identifier: Apache-2.0
#include "services/core/admittance/relation.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/statistics/descriptive.hpp"

namespace stillhand::admittance {
namespace {

bool same_lines(const std::vector<LineResponse>& one, const std::vector<LineResponse>& other) {
  return std::ranges::equal(one, other, [](const LineResponse& a, const LineResponse& b) {
    return std::abs(a.frequency_hz - b.frequency_hz) < 1e-9;
  });
}

double relative(const LineResponse& line) { return line.variance / std::norm(line.response); }

}  // namespace

RelationTest test_relation(const std::vector<LineResponse>& feedthrough_to_position,
                           const std::vector<LineResponse>& held_feedthrough,
                           const std::vector<LineResponse>& stick_per_force,
                           std::int64_t neighbours) {
  if (!same_lines(feedthrough_to_position, held_feedthrough) ||
      !same_lines(feedthrough_to_position, stick_per_force)) {
    throw ConfigError("relation", "records with different lines",
                      "motion lines of two records and the force lines of a swapped one");
  }
  const auto nu = static_cast<double>(neighbours);
  RelationTest out;
  std::vector<double> sizes;
  std::vector<double> radii;
  for (std::size_t k = 0; k < feedthrough_to_position.size(); ++k) {
    const LineResponse& x = feedthrough_to_position[k];
    const LineResponse& h = held_feedthrough[k];
    const LineResponse& y = stick_per_force[k];
    Mismatch mismatch;
    mismatch.line.frequency_hz = x.frequency_hz;
    mismatch.line.response = x.response / (h.response * y.response) - 1.0;
    mismatch.line.variance =
        std::norm(1.0 + mismatch.line.response) * (relative(x) + relative(h) + relative(y));
    // Eq. AD-7 with the fewest neighbours: not smaller than the three together would allow.
    mismatch.line.radius95 =
        std::sqrt(mismatch.line.variance * nu * (std::pow(0.05, -1.0 / nu) - 1.0));
    mismatch.within = std::abs(mismatch.line.response) <= mismatch.line.radius95;
    sizes.push_back(std::abs(mismatch.line.response));
    radii.push_back(mismatch.line.radius95);
    out.share_within += mismatch.within ? 1.0 : 0.0;
    out.lines.push_back(mismatch);
  }
  out.share_within /= static_cast<double>(std::max<std::size_t>(1, out.lines.size()));
  if (out.lines.empty()) return out;
  out.median_mismatch = statistics::median(sizes);
  out.median_radius = statistics::median(radii);
  return out;
}

}  // namespace stillhand::admittance

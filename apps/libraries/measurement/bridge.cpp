// SPDX-License-Identifier: Apache-2.0
#include "apps/libraries/measurement/bridge.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace stillhand::measurement {
namespace {

// Steps through samples and keeps the rows next to the current one.
class Walk {
 public:
  explicit Walk(std::span<const double> places) : places_(places) {}

  // Last row at or before the sample; samples come in order.
  void advance(double sample) {
    while (row_ + 1 < places_.size() && places_[row_ + 1] <= sample) ++row_;
  }
  [[nodiscard]] std::size_t row() const { return row_; }
  [[nodiscard]] bool on_row(double sample) const {
    return places_[row_] == sample || row_ + 1 == places_.size();
  }

 private:
  std::span<const double> places_;
  std::size_t row_ = 0;
};

// Rows of the polynomial between `row` and the next.
struct Support {
  std::array<std::size_t, 4> rows{};
  std::size_t count = 0;
};

Support support_of(std::span<const double> places, std::size_t row) {
  const double gap = places[row + 1] - places[row];
  // With a larger distance the noise of the two outer rows has less weight, and the cubic's own
  // error grows.  At half a period or more, nearly equal times do no harm.  Beyond the second bound
  // the row lies behind another gap.
  const double near = std::max(0.5, 0.25 * gap);
  const double far = 2.0 * near + 2.0;
  Support out;
  std::size_t left = row;
  while (left > 0 && places[row] - places[left] < near) --left;
  const double left_away = places[row] - places[left];
  if (left_away >= near && left_away <= far) out.rows[out.count++] = left;
  out.rows[out.count++] = row;
  out.rows[out.count++] = row + 1;
  std::size_t right = row + 1;
  while (right + 1 < places.size() && places[right] - places[row + 1] < near) ++right;
  const double right_away = places[right] - places[row + 1];
  if (right_away >= near && right_away <= far) out.rows[out.count++] = right;
  return out;
}

// Lagrange's polynomial, Eq. ME-4.  Values near the end of a double's range can overflow in it, and
// times that differ in the last digit divide by zero.  Then a straight line is used, or the row
// before.
double interpolated(std::span<const double> places, std::span<const double> values,
                    const Support& support, std::size_t row, double sample) {
  double sum = 0.0;
  for (std::size_t i = 0; i < support.count; ++i) {
    double weight = 1.0;
    for (std::size_t j = 0; j < support.count; ++j) {
      if (j == i) continue;
      const double other = places[support.rows[j]];
      weight *= (sample - other) / (places[support.rows[i]] - other);
    }
    sum += weight * values[support.rows[i]];
  }
  if (std::isfinite(sum)) return sum;
  const double share = (sample - places[row]) / (places[row + 1] - places[row]);
  const double line = (1.0 - share) * values[row] + share * values[row + 1];
  return std::isfinite(line) ? line : values[row];
}

}  // namespace

void append_on_grid(std::span<const double> places, std::span<const double> values,
                    std::size_t samples, std::vector<double>& out) {
  Walk walk(places);
  for (std::size_t n = 0; n < samples; ++n) {
    const auto sample = static_cast<double>(n);
    walk.advance(sample);
    const std::size_t row = walk.row();
    if (walk.on_row(sample)) {
      out.push_back(values[row]);
      continue;
    }
    out.push_back(interpolated(places, values, support_of(places, row), row, sample));
  }
}

void append_weights(std::span<const double> places, std::size_t samples, std::vector<double>& out) {
  Walk walk(places);
  for (std::size_t n = 0; n < samples; ++n) {
    const auto sample = static_cast<double>(n);
    walk.advance(sample);
    const std::size_t row = walk.row();
    if (walk.on_row(sample)) {
      out.push_back(1.0);
      continue;
    }
    const double before = sample - places[row];
    const double after = places[row + 1] - sample;
    out.push_back(before + after > 1.5 && before > 0.5 && after > 0.5 ? 0.0 : 1.0);
  }
}

}  // namespace stillhand::measurement

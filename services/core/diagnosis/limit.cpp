// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/limit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "services/core/diagnosis/alignment.hpp"
#include "services/core/diagnosis/record/measurement.hpp"
#include "services/core/diagnosis/share_words.hpp"

namespace stillhand::diagnosis {
namespace {

// The rows beyond a limit at one end.
struct LimitEnd {
  double limit = 0.0;
  std::size_t rows = 0;
  double saved = 0.0;  // squared error, of that without a limit
};

// `z`, `y`: from the end inwards, at most half of the rows.  The limit is the mean of y beyond it.
LimitEnd limit_end_of(const std::vector<double>& z, const std::vector<double>& y, double outwards) {
  LimitEnd best{outwards * std::numeric_limits<double>::infinity(), 0, 0.0};
  double sum = 0.0;
  double squares = 0.0;
  double free = 0.0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    sum += y[i];
    squares += y[i] * y[i];
    free += (y[i] - z[i]) * (y[i] - z[i]);
    const auto rows = static_cast<double>(i + 1);
    const double saved = free - (squares - sum * sum / rows);
    if (outwards * sum / rows <= outwards * z[i] && saved > best.saved)
      best = {sum / rows, i + 1, saved};
  }
  return best;
}

// What `given` shows of `wanted`: a filter over `reach` rows to either side, by least squares,
// about the means.
std::vector<double> shown_by(const std::vector<double>& wanted, const std::vector<double>& given,
                             std::size_t reach) {
  const auto rows = static_cast<Eigen::Index>(wanted.size());
  const auto taps = static_cast<Eigen::Index>(2 * reach + 1);
  Eigen::VectorXd y = Eigen::VectorXd::Map(wanted.data(), rows);
  // Zeros on both sides: the mean.
  Eigen::VectorXd x = Eigen::VectorXd::Zero(rows + taps - 1);
  auto inner = x.segment(taps / 2, rows);
  inner = Eigen::VectorXd::Map(given.data(), rows);
  inner.array() -= inner.mean();
  y.array() -= y.mean();
  Eigen::MatrixXd products(taps, taps);
  Eigen::VectorXd with_y(taps);
  for (Eigen::Index i = 0; i < taps; ++i) {
    with_y[i] = x.segment(i, rows).dot(y);
    for (Eigen::Index j = 0; j <= i; ++j) {
      products(i, j) = x.segment(i, rows).dot(x.segment(j, rows));
    }
  }
  products.diagonal() *= 1.0 + 1e-9;  // a band of it has no power
  const Eigen::VectorXd filter = products.selfadjointView<Eigen::Lower>().ldlt().solve(with_y);
  Eigen::VectorXd out = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index i = 0; i < taps; ++i) out += filter[i] * x.segment(i, rows);
  return {out.begin(), out.end()};
}

// Means of so many rows: a limit stays one, and a noise becomes smaller.
std::vector<double> means_of(const std::vector<double>& x, std::size_t rows) {
  std::vector<double> out(x.size() / rows, 0.0);
  for (std::size_t i = 0; i < out.size() * rows; ++i) {
    out[i / rows] += x[i] / static_cast<double>(rows);
  }
  return out;
}

// More rows at an end of the range than a limit behind noise leaves there: a binary signal, or a
// plain limit, which the screening names.
bool has_levels(const std::vector<double>& x) {
  const auto [low, high] = std::ranges::minmax_element(x);
  const auto at_ends = std::ranges::count(x, *low) + std::ranges::count(x, *high);
  return static_cast<double>(at_ends) > 0.5 * kMostClipped * static_cast<double>(x.size());
}

}  // namespace

Limit limit_of(const std::vector<double>& y, const std::vector<double>& p) {
  constexpr std::size_t kMostRows = 5000;
  constexpr int kGains = 30;
  constexpr double kGainStep = 1.05;  // to 4.1: a limit that lets a quarter of the gain through
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < y.size(); i += y.size() / kMostRows + 1) order.push_back(i);
  std::ranges::sort(order, {}, [&](std::size_t i) { return p[i]; });
  const std::size_t n = order.size();
  double mean_p = 0.0, mean_y = 0.0, pp = 0.0, py = 0.0, yy = 0.0;
  for (const std::size_t i : order) {
    mean_p += p[i] / static_cast<double>(n);
    mean_y += y[i] / static_cast<double>(n);
  }
  for (const std::size_t i : order) {
    pp += (p[i] - mean_p) * (p[i] - mean_p);
    py += (p[i] - mean_p) * (y[i] - mean_y);
    yy += (y[i] - mean_y) * (y[i] - mean_y);
  }
  Limit best;
  double gain = py / pp;
  const double without = yy - gain * py;
  const std::size_t half = n / 2;
  for (int step = 0; step < kGains; ++step) {
    // The middle half of the rows lies within both limits; so does its level.
    double level = 0.0;
    for (std::size_t k = n / 4; k < n / 4 + half; ++k) {
      level += (y[order[k]] - gain * p[order[k]]) / static_cast<double>(half);
    }
    double error = 0.0;
    std::vector<double> z[2], of_y[2];
    for (std::size_t k = 0; k < n; ++k) {
      const double predicted = gain * p[order[k]] + level;
      error += (y[order[k]] - predicted) * (y[order[k]] - predicted);
      const std::size_t at = 2 * k < n ? 0 : 1;
      z[at].push_back(predicted);
      of_y[at].push_back(y[order[k]]);
    }
    std::ranges::reverse(z[1]);
    std::ranges::reverse(of_y[1]);
    const LimitEnd low = limit_end_of(z[0], of_y[0], -1.0);
    const LimitEnd high = limit_end_of(z[1], of_y[1], 1.0);
    const double ratio = (error - low.saved - high.saved) / without;
    if (ratio < best.error_ratio) {
      best = {low.limit, high.limit,
              static_cast<double>(low.rows + high.rows) / static_cast<double>(n), ratio};
    }
    gain *= kGainStep;
  }
  return best;
}

std::string limit_in_words(const std::string& input, const std::vector<double>& x,
                           const std::string& output, const std::vector<double>& y,
                           double rate_hz) {
  constexpr double kRate_hz = 50.0;  // five times a hand's fastest
  constexpr double kReach_s = 0.4;   // the inverse of a body answers within a period of 2.5 Hz
  constexpr double kBetter = 0.6;    // of the squared error; a hardening spring leaves 0.71
  constexpr std::size_t kLeastRows = 500;  // ten for each of the filter's
  const auto rows = std::max<std::size_t>(1, static_cast<std::size_t>(rate_hz / kRate_hz + 1e-6));
  const std::vector<double> seen = means_of(x, rows);
  if (seen.size() < kLeastRows || has_levels(x)) return {};
  const double step_hz = rate_hz / static_cast<double>(rows);
  const std::vector<double> shown =
      shown_by(seen, means_of(y, rows), static_cast<std::size_t>(kReach_s * step_hz));
  if (likeness(seen, shown).share < 0.5) return {};
  const Limit limit = limit_of(seen, shown);
  // An input of few levels stays at each of them, and a limit that holds it longer leaves nothing.
  constexpr double kMostShare = 0.75;
  if (limit.share > kMostShare) return {};
  // The rows just beyond a limit are not counted: of 6 % in all 4 %.
  if (limit.share <= 0.5 * kMostClipped || !(limit.error_ratio < kBetter)) return {};
  return output + " shows that " + input + " went on where it stays at a limit, in " +
         share_in_words(limit.share) +
         " of the rows: what its sensor did not see is unknown, and the model's gain is wrong by "
         "about that";
}

}  // namespace stillhand::diagnosis

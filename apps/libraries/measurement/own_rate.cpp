// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <numeric>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "apps/libraries/measurement/sample_faults.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::measurement {
namespace {

constexpr std::size_t kMostRows = 32768;
constexpr double kLeastError = 0.01;  // of the variance
constexpr double kFastest_hz = 10.0;  // of a hand
constexpr double kSlowest_hz = 8.0;   // what beats more slowly is a signal

// First or second differences of the first rows, a power of two of them.
std::vector<double> differences_of(const std::vector<double>& x, int order) {
  std::size_t rows = 1;
  while (2 * rows + 2 <= std::min(x.size(), kMostRows + 2)) rows *= 2;
  std::vector<double> out;
  for (std::size_t i = 1; i <= rows; ++i) {
    out.push_back(order == 1 ? x[i] - x[i - 1] : x[i + 1] - 2.0 * x[i] + x[i - 1]);
  }
  return out;
}

// Without the largest hundredth, which a few blows would fill.
std::vector<double> capped_squares(const std::vector<double>& e) {
  std::vector<double> out;
  for (const double each : e) out.push_back(each * each);
  std::vector<double> sorted = out;
  const auto most = sorted.end() - 1 - std::ssize(sorted) / 100;
  std::ranges::nth_element(sorted, most);
  for (double& each : out) each = std::min(each, *most);
  return out;
}

std::complex<double> line_at(const std::vector<double>& s, double per_row) {
  const auto turn = std::polar(1.0, -2.0 * std::numbers::pi * per_row);
  std::complex<double> phase = 1.0;
  std::complex<double> sum = 0.0;
  for (const double each : s) {
    sum += each * phase;
    phase *= turn;
  }
  return sum;
}

// A line of a spectrum: its frequency [1/row], and its value.
using Line = std::pair<double, std::complex<double>>;

// The largest line within half a bin of one.
Line line_near(const std::vector<double>& s, std::size_t bin) {
  Line best;
  for (int part = -5; part <= 5; ++part) {
    const double at = (static_cast<double>(bin) + 0.1 * part) / static_cast<double>(s.size());
    const double per_row = std::min(at, 0.5);
    const std::complex<double> line = line_at(s, per_row);
    if (std::abs(line) > std::abs(best.second)) best = {per_row, line};
  }
  return best;
}

// The lowest of the largest lines, as those of a comb are alike; none, if they are below `least`.
Line first_line(const std::vector<double>& s, double least) {
  constexpr double kBetweenBins = 0.6;  // of a line, what the bins next to it show at least
  constexpr double kAlike = 0.85;
  constexpr std::size_t kMostLines = 40;
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> lines;
  fft.fwd(lines, s);
  const std::size_t half = s.size() / 2;
  double top = 0.0;
  for (std::size_t k = 2; k <= half; ++k) top = std::max(top, std::abs(lines[k]));
  if (top < kBetweenBins * least) return {};
  std::vector<Line> large;
  for (std::size_t k = 2; k <= half && large.size() < kMostLines; ++k) {
    if (std::abs(lines[k]) >= kBetweenBins * top) large.push_back(line_near(s, k));
  }
  const auto size = [](const Line& line) { return std::abs(line.second); };
  const double largest = size(std::ranges::max(large, {}, size));
  if (largest < least) return {};
  return *std::ranges::find_if(large,
                               [&](const Line& line) { return size(line) >= kAlike * largest; });
}

// Steps at the knots of values held, and what the rows between them move: nothing, where a value is
// held, and back, in the teeth of a saw.  Those of a slow motion go on in their direction from one
// knot to the next, those of a hum turn.
bool are_held(const std::vector<double>& e, double per_row, double phase, bool slow) {
  constexpr double kMostBetween = 0.5;
  double squares = 0.0;
  double onwards = 0.0;
  double between = 0.0;
  double before = 0.0;
  double moved = 0.0;
  std::size_t next = 0;
  const double first = std::fmod(-phase / (2.0 * std::numbers::pi) + 1.0, 1.0) / per_row;
  for (double at = first; at + 2.0 < static_cast<double>(e.size()); at += 1.0 / per_row) {
    if (at < 1.0) continue;
    auto knot = static_cast<std::size_t>(std::lround(at));
    for (const std::size_t other : {knot - 1, knot + 1}) {
      if (std::abs(e[other]) > std::abs(e[knot])) knot = other;
    }
    for (moved = 0.0; next < knot; ++next) moved += e[next];
    next = knot + 1;
    between += before * moved;
    onwards += before * e[knot];
    before = e[knot];
    squares += before * before;
  }
  return std::abs(between) < kMostBetween * squares && (!slow || onwards > 0.0);
}

// At a knot a line bends into the next; a jump bends there and back.  Noise does so everywhere, and
// is known from the rows between.
bool are_bends(const std::vector<double>& e, double per_row, double phase) {
  constexpr double kMostBack = 0.25;         // of a bend; a jump has a half or more
  constexpr double kNoiseTurns = 2.0 / 3.0;  // of its bends
  double knots = 0.0, at_knots = 0.0, next_to = 0.0;
  const double first = std::fmod(-phase / (2.0 * std::numbers::pi) + 1.0, 1.0) / per_row;
  for (double at = first; at + 2.0 < static_cast<double>(e.size()); at += 1.0 / per_row) {
    if (at < 1.0) continue;
    const auto knot = static_cast<std::size_t>(std::lround(at));
    knots += 1.0;
    at_knots += e[knot] * e[knot];
    next_to += 0.5 * e[knot] * (e[knot - 1] + e[knot + 1]);
  }
  double squares = 0.0, products = 0.0;
  for (std::size_t i = 1; i < e.size(); ++i) {
    squares += e[i] * e[i];
    products += e[i] * e[i - 1];
  }
  const double others = static_cast<double>(e.size()) - knots;
  const double noise = (squares - at_knots) / others;
  // From every second row on, each row is next to a knot.
  const double turns =
      per_row < 0.4 ? (products - 2.0 * next_to) / (others - knots) : -kNoiseTurns * noise;
  return next_to / knots - turns >= -kMostBack * (at_knots / knots - noise);
}

// A hum is a line of half the frequency itself, or of what that is an alias of; the share of it is
// twice the line of its squares.  @param line  over the sum of the squares
bool is_hum(const std::vector<double>& e, double per_row, double line) {
  double squares = 0.0;
  for (const double each : e) squares += each * each;
  const double most =
      std::max(std::norm(line_at(e, 0.5 * per_row)), std::norm(line_at(e, 0.5 * (1.0 - per_row))));
  const double share = 2.0 * most / (static_cast<double>(e.size()) * squares);
  return share > 0.5 * line;
}

}  // namespace

double chord_error(const std::vector<double>& x, double rows) {
  double squares = 0.0;
  for (std::size_t i = 1; i + 1 < x.size(); ++i) {
    const double bend = x[i + 1] - 2.0 * x[i] + x[i - 1];
    squares += bend * bend / static_cast<double>(x.size());
  }
  const double deviation = deviation_of(x);
  return rows * rows * rows * squares / 120.0 / (deviation * deviation);
}

double comb_rows(const std::vector<double>& values, int order, double rate_hz) {
  constexpr std::size_t kFewestRows = 256;
  const std::vector<double> e = differences_of(values, order);
  if (e.size() < kFewestRows) return 0.0;
  std::vector<double> squares = capped_squares(e);
  const double sum = std::reduce(squares.begin(), squares.end());
  const auto rows = static_cast<double>(squares.size());
  for (double& each : squares) each -= sum / rows;
  // Knots of values held, at the nearest row, leave sinc(1/k) of a line.  The squares of a sine
  // have one of 0.5, and no second one; those of noise have chance, 2 to 4 over the root of the
  // rows.
  const double least = order == 1 ? 0.6 : std::clamp(8.0 / std::sqrt(rows), 0.12, 0.6);
  const auto [per_row, line] = first_line(squares, least * sum);
  if (per_row * rate_hz < kSlowest_hz) return 0.0;
  const bool has_second = per_row <= 0.25;
  if (has_second && std::abs(line_at(squares, 2.0 * per_row)) < 0.5 * std::abs(line)) return 0.0;
  if (order == 2) {
    constexpr double kLeastAlone = 0.2;  // what a hum and a motion beat with is below
    const double part = std::abs(line) / sum;
    if (!has_second && (part < kLeastAlone || is_hum(e, per_row, part))) return 0.0;
    return are_bends(e, per_row, std::arg(line)) ? 1.0 / per_row : 0.0;
  }
  // A motion of 10 Hz in steps of 40 Hz turns by a quarter from one to the next.
  const bool slow = rate_hz * per_row >= 4.0 * kFastest_hz;
  // What a step costs: see held_rows().
  const double deviation = deviation_of(values);
  const bool costs = sum / rows / per_row / 3.0 >= kLeastError * deviation * deviation;
  return costs && are_held(e, per_row, std::arg(line), slow) ? 1.0 / per_row : 0.0;
}

double uneven_rows(const std::vector<double>& values, double rate_hz) {
  constexpr double kLarge = 2.2;  // deviations: 0.028 of Gauss' noise
  constexpr double kLeastShare = 0.05;
  constexpr double kOnwards = 0.25;  // friction and commands of two levels turn at each jump
  constexpr double kOneWay = 0.2;    // a sawtooth jumps back alone
  const std::vector<double> e = differences_of(values, 1);
  std::vector<double> sizes;
  for (const double each : e) sizes.push_back(std::abs(each));
  const double least = kLarge * 1.4826 * signal::middle_of(std::move(sizes));
  if (least == 0.0) return 0.0;  // runs of equal values: held_rows()
  double jumps = 0.0, up = 0.0, neighbours = 0.0, onwards = 0.0, squares = 0.0, before = 0.0;
  for (std::size_t i = 0; i < e.size(); ++i) {
    if (std::abs(e[i]) <= least) continue;
    jumps += 1.0;
    up += e[i] > 0.0 ? 1.0 : 0.0;
    squares += e[i] * e[i];
    neighbours += i > 0 && std::abs(e[i - 1]) > least ? 1.0 : 0.0;
    onwards += before * e[i] > 0.0 ? 1.0 : 0.0;
    before = e[i];
  }
  const double share = jumps / static_cast<double>(e.size());
  const double deviation = deviation_of(values);
  const bool held = share >= std::max(kLeastShare, kSlowest_hz / rate_hz) &&
                    neighbours < 0.5 * share * jumps && onwards >= kOnwards * jumps &&
                    std::min(up, jumps - up) >= kOneWay * jumps &&
                    squares / jumps / 3.0 >= kLeastError * deviation * deviation;
  return held ? 1.0 / share : 0.0;
}

}  // namespace stillhand::measurement

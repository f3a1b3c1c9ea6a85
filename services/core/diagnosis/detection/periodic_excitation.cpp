// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/periodic_excitation.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numeric>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

constexpr std::size_t kShortest = 16;  // samples of a part worth looking at
// METHOD "Periodic excitation" has the reasons of these.
constexpr double kTolerance = 0.01;       // of the power may fail to repeat
constexpr double kLocalTolerance = 0.04;  // of an eighth of a period alone
constexpr double kAsGood = 1.5;           // times the least deviation: the shortest lag is taken
constexpr double kExact = 1e-4;     // over the whole part: a phase error grows with its periods
constexpr double kCandidate = 0.5;  // a lag worth cutting off what doesn't repeat

// The longest stretch without its unjudged start.
Stretch longest_part(const Signals& signals) {
  Stretch longest;
  for (Stretch part : signals.stretches()) {
    while (part.first < part.end && !(signals.weight()[part.first] > 0.0)) ++part.first;
    if (part.end - part.first > longest.end - longest.first) longest = part;
  }
  return longest;
}

// An input about its mean over a part, and its running sum of squares.
struct Part {
  std::vector<double> x;
  std::vector<double> squares;  // of the first n
  double variance = 0.0;
};

Part part_of(const std::vector<double>& values, const Stretch& part) {
  Part result;
  result.x.assign(values.begin() + static_cast<std::ptrdiff_t>(part.first),
                  values.begin() + static_cast<std::ptrdiff_t>(part.end));
  const auto count = static_cast<double>(result.x.size());
  const double mean = std::accumulate(result.x.begin(), result.x.end(), 0.0) / count;
  result.squares.assign(1, 0.0);
  for (double& value : result.x) {
    value -= mean;
    result.squares.push_back(result.squares.back() + value * value);
  }
  result.variance = result.squares.back() / count;
  return result;
}

// sum (x(n) - x(n+L))^2 over the sum of both squares, by lag up to half the length: 0 where it
// repeats, 1 where it has nothing to do with itself.  Eq. DG-41.
std::vector<double> deviations_of(const Part& part) {
  const std::size_t count = part.x.size();
  const std::size_t lags = count / 2;
  std::vector<double> padded = part.x;
  padded.resize(std::bit_ceil(count + lags + 1), 0.0);
  Eigen::FFT<double> transform;
  transform.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<Complex> spectrum;
  transform.fwd(spectrum, padded);
  for (Complex& line : spectrum) line = std::norm(line);
  transform.inv(padded, spectrum);
  std::vector<double> deviations(lags + 1);
  for (std::size_t lag = 0; lag <= lags; ++lag) {
    const double energies = part.squares[count - lag] + part.squares.back() - part.squares[lag];
    deviations[lag] = std::max(1.0 - 2.0 * padded[lag] / std::max(energies, 1e-300), 0.0);
  }
  return deviations;
}

// The largest deviation of all inputs by lag; before all have lost touch with themselves 1.
std::vector<double> joint_deviations(const std::vector<Part>& parts) {
  std::vector<double> joint(parts.front().x.size() / 2 + 1, 0.0);
  for (const Part& part : parts) {
    const std::vector<double> own = deviations_of(part);
    bool apart = false;
    for (std::size_t lag = 0; lag < own.size(); ++lag) {
      apart = apart || own[lag] >= 1.0;
      joint[lag] = std::max(joint[lag], apart ? own[lag] : 1.0);
    }
  }
  return joint;
}

std::size_t shortest_good_lag(const std::vector<double>& deviations) {
  const double least = *std::ranges::min_element(deviations);
  if (least > kCandidate) return 0;
  // A lag that is off by a part of a sample is off by more with every period.
  const auto bound_at = [&](std::size_t lag) {
    const double part = static_cast<double>(lag) / static_cast<double>(2 * deviations.size());
    return std::max(kAsGood * least, kExact * part * part);
  };
  std::size_t lag = 0;
  while (deviations[lag] > bound_at(lag)) ++lag;
  while (lag + 1 < deviations.size() && deviations[lag + 1] < deviations[lag]) ++lag;
  return lag;
}

// The longest run in which every eighth of a period repeats a period later.
Periodicity periodic_run(const std::vector<Part>& parts, std::size_t period) {
  const std::size_t pairs = parts.front().x.size() - period;
  std::vector<std::vector<double>> sums;  // of squared differences of the first n, over 2 variances
  for (const Part& part : parts) {
    sums.emplace_back(1, 0.0);
    for (std::size_t n = 0; n < pairs; ++n) {
      const double d = part.x[n] - part.x[n + period];
      sums.back().push_back(sums.back().back() + 0.5 * d * d / std::max(part.variance, 1e-300));
    }
  }
  const auto mean_over = [&](std::size_t from, std::size_t to) {
    double largest = 0.0;
    for (const auto& sum : sums) {
      largest = std::max(largest, (sum[to] - sum[from]) / static_cast<double>(to - from));
    }
    return largest;
  };
  const std::size_t window = std::max<std::size_t>(period / 8, 1);
  std::size_t best_from = 0;
  std::size_t best_to = 0;
  std::size_t from = 0;
  for (std::size_t n = 0; n < pairs; n += window) {
    const std::size_t to = std::min(n + window, pairs);
    if (mean_over(n, to) > kLocalTolerance) {
      from = to;
    } else if (to - from > best_to - best_from) {
      best_from = from;
      best_to = to;
    }
  }
  Periodicity run;
  if (best_to - best_from < period) return run;
  run.period = period;
  run.periods = (best_to - best_from) / period + 1;
  run.first = best_to + period - run.period * run.periods;  // the end is steadier than the start
  run.deviation = mean_over(run.first, best_to);
  return run;
}

}  // namespace

std::optional<Periodicity> periodicity_of(const Signals& signals) {
  const Stretch part = longest_part(signals);
  if (part.end - part.first < kShortest) return {};
  std::vector<Part> parts;
  for (const Signal& input : signals.inputs()) parts.push_back(part_of(input.values, part));
  const std::size_t period = shortest_good_lag(joint_deviations(parts));
  if (period < 4) return {};
  Periodicity run = periodic_run(parts, period);
  if (run.periods < 2 || run.deviation > kTolerance) return {};
  run.first += part.first;
  return run;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/detection/detection_lines.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/core/diagnosis/detection/fourier_lines.hpp"
#include "services/core/statistics/distributions.hpp"

namespace stillhand::diagnosis {
namespace {

using Complex = std::complex<double>;

// A line of less than a thousandth of the strongest's power moves the output by less than 3 % of
// it; what it does is linear and in the model.
constexpr double kLeastExcitation = 1e-3;
constexpr double kOverInputNoise = 10.0;
// Lines at each side that give the level of the noise, with 32 degrees of freedom.
constexpr std::size_t kMostNeighbours = 8;
constexpr std::size_t kOddReach = 3;   // cubes of lines reach to three times the highest,
constexpr std::size_t kEvenReach = 2;  // squares to twice
// [-] of the output: the steps of a converter of ten bits, 3e-4 of its range, repeat too and are
// no effect.
constexpr double kLeastLevel = 1e-3;

std::vector<Complex> lines_of(const std::vector<double>& values, const Periodicity& used) {
  std::vector<double> x(values.begin() + static_cast<std::ptrdiff_t>(used.first),
                        values.begin() + static_cast<std::ptrdiff_t>(used.end()));
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
  for (double& value : x) value -= mean;
  return fourier_lines(x);
}

// Mean power of the lines on both sides of a harmonic that are none, at most `spacing` - 1 each.
double power_around(const std::vector<Complex>& lines, std::size_t at, std::size_t spacing,
                    double& count) {
  const std::size_t reach = std::min(spacing - 1, kMostNeighbours);
  double sum = 0.0;
  count = 0.0;
  for (std::size_t d = 1; d <= reach; ++d) {
    for (const std::size_t j : {at - d, at + d}) {
      if (j == 0 || j + 1 >= lines.size()) continue;
      sum += std::norm(lines[j]);
      count += 1.0;
    }
  }
  return sum / std::max(count, 1.0);
}

// Excited lines of one or several inputs, as multiples of 1 / period.
std::vector<std::size_t> excited_harmonics(const Signals& signals, const Periodicity& used) {
  std::vector<bool> excited;
  for (const Signal& input : signals.inputs()) {
    const std::vector<Complex> lines = lines_of(input.values, used);
    const std::size_t harmonics = (lines.size() - 2) / used.periods;
    excited.resize(harmonics + 1, false);
    double strongest = 0.0;
    for (std::size_t h = 1; h <= harmonics; ++h) {
      strongest = std::max(strongest, std::norm(lines[h * used.periods]));
    }
    for (std::size_t h = 1; h <= harmonics; ++h) {
      double count = 0.0;
      const double noise = power_around(lines, h * used.periods, used.periods, count);
      const double power = std::norm(lines[h * used.periods]);
      if (power > kLeastExcitation * strongest && power > kOverInputNoise * noise) {
        excited[h] = true;
      }
    }
  }
  std::vector<std::size_t> harmonics;
  for (std::size_t h = 1; h < excited.size(); ++h) {
    if (excited[h]) harmonics.push_back(h);
  }
  return harmonics;
}

// Gathers lines and their evidence.
class Gathering {
 public:
  Gathering(const std::vector<Complex>& residual, const std::vector<Complex>& output,
            std::size_t spacing, const Periodicity& used, double rate_hz)
      : residual_(residual),
        output_(output),
        spacing_(spacing),
        samples_(static_cast<double>(used.end() - used.first)),
        rate_hz_(rate_hz) {}

  void add(std::size_t order, LineGroup& group, double& excess, double& fisher) const {
    const std::size_t at = order * spacing_;
    double count = 0.0;
    const double noise = power_around(residual_, at, spacing_, count);
    const double power = std::norm(residual_[at]);
    group.frequency_hz.push_back(static_cast<double>(at) * rate_hz_ / samples_);
    group.output.push_back(rms_of(std::norm(output_[at])));
    group.residual.push_back(rms_of(power));
    group.noise.push_back(rms_of(noise));
    excess += power - noise;
    // F with 2 and 2 n degrees of freedom has the tail (1 + F/n)^-n.
    fisher += 2.0 * count * std::log1p(power / std::max(count * noise, 1e-300));
  }

 private:
  [[nodiscard]] double rms_of(double power) const { return std::sqrt(2.0 * power) / samples_; }

  const std::vector<Complex>& residual_;
  const std::vector<Complex>& output_;
  std::size_t spacing_;
  double samples_;
  double rate_hz_;
};

double sum_of_powers(const std::vector<Complex>& lines) {
  double sum = 0.0;
  for (std::size_t j = 1; j < lines.size(); ++j) sum += std::norm(lines[j]);
  return sum;
}

}  // namespace

std::optional<PeriodicExcitation> periodic_excitation_of(const Signals& signals) {
  const std::optional<Periodicity> periodicity = periodicity_of(signals);
  if (!periodicity) return {};
  PeriodicExcitation result{*periodicity, excited_harmonics(signals, *periodicity)};
  if (result.excited.empty()) return {};
  return result;
}

DetectionLines detection_lines(const RepeatedResidual& repeated,
                               const std::vector<std::size_t>& excited_lines,
                               const Signals& signals) {
  DetectionLines result;
  const Periodicity& used = repeated.used;
  result.periodicity = used;
  result.repeats = repeated.repeats;
  const std::size_t divisor = std::accumulate(excited_lines.begin(), excited_lines.end(),
                                              std::size_t{0}, std::gcd<std::size_t, std::size_t>);
  const std::size_t spacing = divisor * used.periods;
  const double samples = static_cast<double>(used.end() - used.first);
  result.fundamental_hz = static_cast<double>(spacing) * signals.rate_hz() / samples;
  result.odd_excitation =
      std::ranges::all_of(excited_lines, [&](std::size_t h) { return h / divisor % 2 == 1; });
  const std::vector<Complex> output = lines_of(signals.output().values, used);
  const Gathering gathering(repeated.lines, output, spacing, used, signals.rate_hz());
  const double total = std::max(sum_of_powers(repeated.lines), 1e-300);
  const double least = kLeastLevel * kLeastLevel * sum_of_powers(output);
  const std::size_t highest = excited_lines.back() / divisor;
  const auto gather = [&](LineGroup& group, auto belongs) {
    double excess = 0.0;
    double fisher = 0.0;
    // The last line may be half a rate, which is real.
    for (std::size_t order = 1;
         order <= kOddReach * highest && order * spacing + 1 < repeated.lines.size(); ++order) {
      const bool excited = std::ranges::binary_search(excited_lines, order * divisor);
      if (belongs(order, excited)) gathering.add(order, group, excess, fisher);
    }
    if (group.empty()) return;
    group.share = excess / total;
    if (excess < least) return;
    group.p = statistics::chi_squared_above(fisher, 2.0 * static_cast<double>(group.output.size()));
  };
  gather(result.excited, [](std::size_t, bool excited) { return excited; });
  if (result.odd_excitation) {
    gather(result.odd, [](std::size_t order, bool excited) { return !excited && order % 2 == 1; });
    gather(result.even, [&](std::size_t order, bool excited) {
      return !excited && order % 2 == 0 && order <= kEvenReach * highest;
    });
  } else {
    gather(result.odd_or_even, [](std::size_t, bool excited) { return !excited; });
  }
  return result;
}

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/alignment.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "services/core/diagnosis/record/digits.hpp"
#include "services/core/diagnosis/share_words.hpp"

namespace stillhand::diagnosis {
namespace {

constexpr double kRate_hz = 50.0;        // a hand moves at 0.1 to 10 Hz
constexpr double kLowestRate_hz = 20.0;  // what is slower lags by more than a body does
constexpr double kLongestLag_s = 10.0;
constexpr double kLargestDrift = 0.02;  // as clock_drift's
constexpr double kSegments = 16.0;
constexpr double kShortestSegment_s = 2.0;
constexpr double kLongestSegment_s = 20.0;
constexpr double kFine_s = 0.04;   // a sixth of a period at 4 Hz, over half of the record
constexpr double kLeast_s = 0.01;  // a 25th of it: what is less costs hardly anything

// Means over `factor` samples, about the mean of all.
std::vector<double> thinned(const std::vector<double>& x, std::size_t factor) {
  std::vector<double> out(x.size() / factor, 0.0);
  double mean = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) {
    for (std::size_t j = 0; j < factor; ++j) {
      out[i] += x[i * factor + j] / static_cast<double>(factor);
    }
    mean += out[i] / static_cast<double>(out.size());
  }
  for (double& value : out) value -= mean;
  return out;
}

// Correlations of the segments over the lags -most .. most.
class Correlations {
 public:
  Correlations(const std::vector<double>& x, const std::vector<double>& y, double rate_hz)
      : rate_hz_(rate_hz) {
    const double length_s = static_cast<double>(x.size()) / rate_hz;
    most_ = static_cast<std::ptrdiff_t>(std::min(kLongestLag_s, length_s / 4.0) * rate_hz);
    const double segment_s =
        std::clamp(length_s / kSegments, kShortestSegment_s, kLongestSegment_s);
    const auto length = static_cast<std::ptrdiff_t>(segment_s * rate_hz);
    const auto size = std::ssize(x);
    for (std::ptrdiff_t first = 0; first + length <= size; first += length) {
      std::vector<double> sums(static_cast<std::size_t>(2 * most_ + 1), 0.0);
      for (std::ptrdiff_t lag = -most_; lag <= most_; ++lag) {
        double sum = 0.0;
        const std::ptrdiff_t end = std::min(first + length, size + lag);
        for (std::ptrdiff_t i = std::max(first, lag); i < end; ++i) {
          sum += y[static_cast<std::size_t>(i)] * x[static_cast<std::size_t>(i - lag)];
        }
        sums[static_cast<std::size_t>(lag + most_)] = sum;
      }
      sums_.push_back(std::move(sums));
      times_s_.push_back((static_cast<double>(first) + 0.5 * static_cast<double>(length)) /
                         rate_hz);
    }
  }

  [[nodiscard]] double longest_s() const { return static_cast<double>(most_) / rate_hz_; }
  [[nodiscard]] double at(const Alignment& tried) const {
    double sum = 0.0;
    for (std::size_t s = 0; s < sums_.size(); ++s) {
      const double place = tried.delay_s(times_s_[s]) * rate_hz_ + static_cast<double>(most_);
      if (place < 0.0 || place >= static_cast<double>(2 * most_)) continue;
      const auto below = static_cast<std::size_t>(place);
      const double part = place - static_cast<double>(below);
      sum += (1.0 - part) * sums_[s][below] + part * sums_[s][below + 1];
    }
    return std::abs(sum);
  }

 private:
  double rate_hz_;
  std::ptrdiff_t most_ = 0;
  std::vector<std::vector<double>> sums_;
  std::vector<double> times_s_;
};

}  // namespace

Alignment aligned(const std::vector<double>& x, const std::vector<double>& y, double rate_hz) {
  const auto factor = static_cast<std::size_t>(std::max(1.0, std::floor(rate_hz / kRate_hz)));
  const double slow_hz = rate_hz / static_cast<double>(factor);
  const double length_s = static_cast<double>(x.size()) / rate_hz;
  Alignment best{0.0, 0.0, 0.5 * length_s};
  if (rate_hz < kLowestRate_hz) return best;
  const Correlations correlations(thinned(x, factor), thinned(y, factor), slow_hz);
  double most = correlations.at(best);
  const auto search = [&](const Alignment around, double lag_s, double lag_step_s, double drift,
                          double drift_step) {
    const auto lags = static_cast<int>(std::ceil(lag_s / lag_step_s));
    const auto drifts = static_cast<int>(std::ceil(drift / drift_step));
    for (int d = -drifts; d <= drifts; ++d) {
      for (int l = -lags; l <= lags; ++l) {
        const Alignment tried{around.lag_s + l * lag_step_s, around.drift + d * drift_step,
                              around.middle_s};
        const double sum = correlations.at(tried);
        if (sum > most) {
          most = sum;
          best = tried;
        }
      }
    }
  };
  const double longest_s = correlations.longest_s();
  const double drift_step = 2.0 * kFine_s / length_s;
  search(best, longest_s, kFine_s, std::min(kLargestDrift, 2.0 * longest_s / length_s), drift_step);
  const Alignment coarse = best;
  search(coarse, kFine_s, kFine_s / 8.0, drift_step, drift_step / 8.0);
  return best;
}

bool drifts(const Alignment& found) { return std::abs(found.drift) * found.middle_s >= kLeast_s; }

std::vector<Alignment> readings(const Alignment& found) {
  // The range of `delay`, which is an effect.
  constexpr double kEarliest_s = -0.1;
  constexpr double kLatest_s = 0.5;
  if (!drifts(found) && found.lag_s >= kEarliest_s && found.lag_s <= kLatest_s) return {};
  std::vector<Alignment> out;
  for (const double of_body_s : {0.0, 0.05, 0.1, 0.15}) {
    out.push_back({found.lag_s - of_body_s, found.drift, found.middle_s});
  }
  return out;
}

std::vector<double> moved(const std::vector<double>& x, double rate_hz, const Alignment& by) {
  std::vector<double> out(x.size());
  const double last = static_cast<double>(x.size() - 1);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double time_s = static_cast<double>(i) / rate_hz;
    const double place = std::clamp((time_s - by.delay_s(time_s)) * rate_hz, 0.0, last);
    const auto below = std::min(static_cast<std::size_t>(place), x.size() - 2);
    const double part = place - static_cast<double>(below);
    out[i] = (1.0 - part) * x[below] + part * x[below + 1];
  }
  return out;
}

std::string in_words(const Alignment& alignment) {
  const std::string by = (alignment.lag_s < 0.0 ? "leads the input by " : "follows the input by ") +
                         digits(std::abs(alignment.lag_s), 3) + " s";
  if (!drifts(alignment)) return "the output " + by;
  return "two clocks: the output's lag grows by " + digits(100.0 * alignment.drift, 3) +
         " % of the time, and in the middle it " + by;
}

std::string swapped_in_words(const std::string& input, double back, const std::string& output,
                             double here) {
  return output + " leads " + input + ", or the columns are swapped: " + output + " explains " +
         share_in_words(back) + " of " + input + ", and " + input + " " + share_in_words(here) +
         " of " + output;
}

std::string lead_in_words(const std::string& input, const std::string& output, double lead_s,
                          double with, double left) {
  return output + " leads " + input + ": a model that knows " + input + " " + digits(lead_s, 3) +
         " s ahead leaves " + digits(100.0 * with, 3) + " % of " + output + ", this one " +
         digits(100.0 * left, 3) + " %: the columns may be swapped, or " + input + " comes late";
}

std::string one_sensor_twice(const std::string& input, const std::vector<double>& x,
                             const std::string& output, const std::vector<double>& y) {
  const Likeness line = likeness(x, y);
  if (!(1.0 - line.share < kTwoSensors)) return {};
  return output + " is a constant times " + input + " (" + digits(line.gain, 4) +
         "): one sensor twice?";
}

Likeness likeness(const std::vector<double>& x, const std::vector<double>& y) {
  const auto count = static_cast<double>(x.size());
  const double mean_x = std::reduce(x.begin(), x.end()) / count;
  const double mean_y = std::reduce(y.begin(), y.end()) / count;
  double products = 0.0;
  double squares_x = 0.0;
  double squares_y = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    products += (x[n] - mean_x) * (y[n] - mean_y);
    squares_x += (x[n] - mean_x) * (x[n] - mean_x);
    squares_y += (y[n] - mean_y) * (y[n] - mean_y);
  }
  if (!(squares_x > 0.0 && squares_y > 0.0)) return {};
  return {products / squares_x, products / squares_x * (products / squares_y)};
}

std::string unlikely_mass(const Motion& motion) {
  constexpr double kLightest_kg = 0.01;  // a finger
  if (!why_unchecked(motion).empty() || !(motion.input_m_s2 > 0.0)) return {};
  const double mass_kg = motion.explained_n / motion.input_m_s2;
  if (mass_kg >= kLightest_kg && mass_kg <= motion.heaviest_kg) return {};
  return digits(motion.explained_n, 3) + " N of " + motion.output + " follow " +
         digits(motion.input_m_s2, 3) + " m/s^2 of " + motion.input + ", as a body of " +
         digits(mass_kg, 3) + " kg would, and " +
         (motion.heaviest_kg == kHeaviestHand_kg ? "a hand's is" : "what was stated is") +
         " 0.01 to " + digits(motion.heaviest_kg, 4) + " kg: one of the units is wrong";
}

std::string why_unchecked(const Motion& motion) {
  if (motion.input_unit == "m/s^2" && motion.output_unit == "N") return {};
  return "units not checked, because only a motion in m/s^2 and a force in N have a hand's mass, "
         "and these are " +
         motion.input + " [" + motion.input_unit + "] and " + motion.output + " [" +
         motion.output_unit + "]";
}

}  // namespace stillhand::diagnosis

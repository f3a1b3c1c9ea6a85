// SPDX-License-Identifier: Apache-2.0
#include "apps/diagnose/enough.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/contract/config_error.hpp"

namespace stillhand::diagnose {
namespace {

constexpr double kEachNumber = 10.0;  // [samples]
constexpr double kPeriods = 2.0;
constexpr double kSeen = 0.8;  // of the samples: four folds of five

// Poles, numerators and offset.
double numbers_of(const diagnosis::DiagnoseOptions& options) {
  const auto inputs = static_cast<double>(options.inputs.size());
  if (options.model == diagnosis::ModelClass::kLinear) return inputs + 1.0;
  const double order = options.order;
  return order + inputs * (order + 1.0) + 1.0;
}

// [samples] Of one input; 0: it does not move.
double period_of(const std::vector<diagnosis::Measurement>& recordings, const std::string& input) {
  double square = 0.0;
  double steps = 0.0;
  for (const diagnosis::Measurement& each : recordings) {
    const std::vector<double>& u = each.find(input)->values;
    double mean = 0.0;
    for (const double value : u) mean += value / static_cast<double>(u.size());
    for (std::size_t n = 0; n < u.size(); ++n) {
      square += (u[n] - mean) * (u[n] - mean);
      if (n > 0) steps += (u[n] - u[n - 1]) * (u[n] - u[n - 1]);
    }
  }
  return steps > 0.0 ? 2.0 * std::numbers::pi * std::sqrt(square / steps) : 0.0;
}

double slowest_period(const std::vector<diagnosis::Measurement>& recordings,
                      const diagnosis::DiagnoseOptions& options) {
  double longest = 0.0;
  for (const std::string& input : options.inputs) {
    longest = std::max(longest, period_of(recordings, input));
  }
  return longest;
}

}  // namespace

std::size_t fewest_samples(const std::vector<diagnosis::Measurement>& recordings,
                           const diagnosis::DiagnoseOptions& options) {
  return static_cast<std::size_t>(std::ceil(std::max(
      kEachNumber * numbers_of(options) / kSeen, kPeriods * slowest_period(recordings, options))));
}

void check_enough(const std::vector<diagnosis::Measurement>& recordings,
                  const diagnosis::DiagnoseOptions& options) {
  std::size_t samples = 0;
  for (const diagnosis::Measurement& each : recordings) {
    samples += static_cast<std::size_t>(
        std::ranges::count_if(each.weight, [](double weight) { return weight > 0.0; }));
  }
  const std::size_t fewest = fewest_samples(recordings, options);
  if (samples >= fewest) return;
  const double rate_hz = recordings.front().rate_hz;
  throw ConfigError(
      recordings.front().source, fmt::format("{} samples", samples),
      fmt::format("{} ({:.3g} s) or more: ten for each of the model's {:g} numbers, of which a fit "
                  "sees four fifths, and two periods of the motion, {:.2g} s each",
                  fewest, static_cast<double>(fewest) / rate_hz, numbers_of(options),
                  slowest_period(recordings, options) / rate_hz));
}

}  // namespace stillhand::diagnose

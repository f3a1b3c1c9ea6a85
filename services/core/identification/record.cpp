// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/record.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/expects.hpp"
#include "services/core/signal/moments.hpp"

namespace stillhand::identification {
namespace {

constexpr double kLargestValue = 1e30;  // its square's square is a number

void check_finite(const std::vector<double>& samples, const std::string& channel) {
  for (std::size_t n = 0; n < samples.size(); ++n) {
    if (!(std::abs(samples[n]) < kLargestValue)) {
      std::array<char, 32> value{};
      std::snprintf(value.data(), value.size(), "%.3g", samples[n]);
      throw ConfigError("recording, " + channel + ", sample " + std::to_string(n + 1), value.data(),
                        "a finite value, below 1e30 in size");
    }
  }
}

// Prediction of each sample from the measured past, Eq. ID-1.
std::vector<double> one_step(const DifferenceModel& model, const Record& record,
                             std::size_t first) {
  std::vector<double> predicted;
  predicted.reserve(record.size() - first);
  for (std::size_t n = first; n < record.size(); ++n) {
    double f = model.numerator[0] * record.acceleration_m_s2[n];
    for (std::size_t i = 1; i <= model.order(); ++i) {
      f += model.numerator[i] * record.acceleration_m_s2[n - i];
      f -= model.denominator[i] * record.force_n[n - i];
    }
    predicted.push_back(f);
  }
  return predicted;
}

}  // namespace

void check(const Record& record) {
  if (!(record.rate_hz > 0.0) || !std::isfinite(record.rate_hz)) {
    throw ConfigError("recording, sample rate [Hz]", std::to_string(record.rate_hz),
                      "a positive finite value");
  }
  if (record.acceleration_m_s2.size() != record.force_n.size()) {
    throw ConfigError(
        "recording, force", std::to_string(record.force_n.size()) + " samples",
        std::to_string(record.acceleration_m_s2.size()) + ", as many as of the acceleration");
  }
  check_finite(record.acceleration_m_s2, "acceleration");
  check_finite(record.force_n, "force");
}

Record part(const Record& record, std::size_t first, std::size_t count) {
  STILLHAND_EXPECTS(first + count <= record.size());
  const auto cut = [&](const std::vector<double>& all) {
    const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
    return std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));
  };
  return {record.rate_hz, cut(record.acceleration_m_s2), cut(record.force_n)};
}

double vaf_percent(const std::vector<double>& measured, const std::vector<double>& predicted) {
  STILLHAND_EXPECTS(measured.size() == predicted.size() && !measured.empty());
  std::vector<double> error(measured.size());
  for (std::size_t n = 0; n < error.size(); ++n) error[n] = measured[n] - predicted[n];
  return 100.0 * (1.0 - signal::variance(error) / signal::variance(measured));
}

double rms_difference(const std::vector<double>& measured, const std::vector<double>& predicted) {
  STILLHAND_EXPECTS(measured.size() == predicted.size() && !measured.empty());
  double sum = 0.0;
  for (std::size_t n = 0; n < measured.size(); ++n) {
    sum += (measured[n] - predicted[n]) * (measured[n] - predicted[n]);
  }
  return std::sqrt(sum / static_cast<double>(measured.size()));
}

FitQuality quality(const DifferenceModel& model, const Record& record, std::size_t first) {
  STILLHAND_EXPECTS(signal::well_formed(model));
  first = std::max(first, model.order());
  STILLHAND_EXPECTS(first < record.size());
  const auto from = static_cast<std::ptrdiff_t>(first);
  const std::vector<double> measured(record.force_n.begin() + from, record.force_n.end());
  const std::vector<double> next = one_step(model, record, first);
  std::vector<double> free_run = signal::simulated(model, record.acceleration_m_s2);
  free_run.erase(free_run.begin(), free_run.begin() + from);
  FitQuality out;
  out.one_step_rms_n = rms_difference(measured, next);
  out.one_step_vaf_percent = vaf_percent(measured, next);
  out.free_run_rms_n = rms_difference(measured, free_run);
  out.free_run_vaf_percent = vaf_percent(measured, free_run);
  out.samples = measured.size();
  return out;
}

}  // namespace stillhand::identification

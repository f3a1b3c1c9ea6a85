// SPDX-License-Identifier: Apache-2.0
#include "cancellation/core/model_check.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <exception>
#include <numbers>
#include <vector>

#include "cancellation/core/model_filter.hpp"
#include "contract/tick.hpp"

namespace stillhand::cancellation {
namespace {

bool finite(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// Largest |H| found; NaN when any value isn't finite.
double peak_gain(const ControlRateModel& model, const std::vector<std::complex<double>>& poles) {
  double peak = 0.0;
  const auto look = [&](double frequency_hz) {
    const double gain = std::abs(signal::response_at(model, frequency_hz));
    if (!(gain <= peak)) peak = gain;
  };
  constexpr int kPoints = 400;
  look(0.0);
  for (int i = 0; i <= kPoints && std::isfinite(peak); ++i) {
    // From 0.01 Hz up, evenly in log frequency: 85 a decade.
    look(0.01 * std::pow(0.5 * kControlRateHz / 0.01, static_cast<double>(i) / kPoints));
  }
  for (const std::complex<double>& pole : poles) {
    if (!std::isfinite(peak)) break;
    look(std::abs(std::arg(pole)) * kControlRateHz / (2.0 * std::numbers::pi));
  }
  return peak;
}

// Ticks until radius^n = 0.01, for every pole; above the limit when a pole is at or beyond 1.
std::int64_t settle_ticks(const std::vector<std::complex<double>>& poles) {
  std::int64_t slowest = 1;
  for (const std::complex<double>& pole : poles) {
    const double radius = std::abs(pole);
    if (!(radius < 1.0)) return kMaxSettle_ticks + 1;
    if (radius < 1e-6) continue;
    const double ticks = std::ceil(std::log(0.01) / std::log(radius));
    if (!(ticks <= static_cast<double>(kMaxSettle_ticks))) return kMaxSettle_ticks + 1;
    slowest = std::max(slowest, static_cast<std::int64_t>(ticks));
  }
  return slowest;
}

ModelCheck checked(const ControlRateModel& model, double max_gain_n_s2_m) {
  if (model.denominator.empty() || model.numerator.size() != model.denominator.size()) {
    return {Refusal::kMalformed, 0};
  }
  if (!finite(model.numerator) || !finite(model.denominator)) return {Refusal::kNotFinite, 0};
  if (model.rate_hz != kControlRateHz) return {Refusal::kWrongRate, 0};
  if (model.order() > ModelFilter::kMaxOrder) return {Refusal::kOrder, 0};
  if (!signal::well_formed(model)) return {Refusal::kMalformed, 0};
  if (!signal::is_stable(model)) return {Refusal::kUnstable, 0};
  const std::vector<std::complex<double>> poles = signal::poles(model);
  for (const std::complex<double>& pole : poles) {
    if (!(std::abs(pole) < 1.0)) return {Refusal::kUnstable, 0};
  }
  const std::int64_t settle = settle_ticks(poles);
  if (settle > kMaxSettle_ticks) return {Refusal::kSettling, 0};
  // Also refuses a NaN gain.
  if (!(peak_gain(model, poles) <= max_gain_n_s2_m)) return {Refusal::kGain, 0};
  return {Refusal::kNone, settle};
}

}  // namespace

std::string_view describe(Refusal refusal) noexcept {
  switch (refusal) {
    case Refusal::kNone:
      return "model taken";
    case Refusal::kMalformed:
      return "model is empty, its sizes differ, or its denominator doesn't start with 1";
    case Refusal::kNotFinite:
      return "a coefficient is not a finite number";
    case Refusal::kWrongRate:
      return "model is not at exactly 1000 Hz";
    case Refusal::kOrder:
      return "model order is above 12";
    case Refusal::kUnstable:
      return "a pole lies on or outside the unit circle";
    case Refusal::kSettling:
      return "model takes longer than 10 s to settle";
    case Refusal::kGain:
      return "model gain is above the bound";
  }
  return "unknown";
}

ModelCheck check_model(const ControlRateModel& model, double max_gain_n_s2_m) noexcept {
  try {
    return checked(model, max_gain_n_s2_m);
  } catch (const std::exception&) {
    // Only memory can run out in there; the live path must not end for a model.
    return {Refusal::kMalformed, 0};
  }
}

}  // namespace stillhand::cancellation

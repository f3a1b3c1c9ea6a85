// SPDX-License-Identifier: Apache-2.0
#include "services/core/diagnosis/model/size.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "services/core/signal/difference_model.hpp"

namespace stillhand::diagnosis {
namespace {

std::complex<double> late_by_one(double frequency_hz, double rate_hz) {
  return std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz / rate_hz);
}

}  // namespace

std::complex<double> polynomial_at(const std::vector<double>& c, double frequency_hz,
                                   double rate_hz) {
  return signal::polynomial_at(c, late_by_one(frequency_hz, rate_hz));
}

std::complex<double> difference_polynomial_at(const std::vector<double>& d, double frequency_hz,
                                              double rate_hz) {
  return signal::polynomial_at(d, 1.0 - late_by_one(frequency_hz, rate_hz));
}

std::complex<double> through_body_at(const SizeCase& at, double frequency_hz) {
  const double rate_hz = at.model.rate_hz;
  return difference_polynomial_at(at.effect().coefficients, frequency_hz, rate_hz) /
         polynomial_at(at.model.body.denominator, frequency_hz, rate_hz);
}

double largest_deflection(const std::vector<double>& x, double centre, const Signals& signals) {
  double largest = 0.0;
  for (std::size_t n = 0; n < x.size(); ++n) {
    if (signals.weight()[n] > 0.0) largest = std::max(largest, std::abs(x[n] - centre));
  }
  return largest;
}

bool is_plain_unit(std::string_view unit) { return unit.empty() || unit == "-" || unit == "1"; }

std::string unit_over(std::string_view over, std::string_view under) {
  if (over == under || (is_plain_unit(over) && is_plain_unit(under))) return "-";
  if (is_plain_unit(under)) return std::string(over);
  std::string below(under);
  if (below.find_first_of("/* ") != std::string::npos) below = "(" + below + ")";
  return (is_plain_unit(over) ? "1" : std::string(over)) + "/" + below;
}

}  // namespace stillhand::diagnosis

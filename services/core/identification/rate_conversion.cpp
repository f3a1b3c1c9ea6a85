// SPDX-License-Identifier: Apache-2.0
#include "services/core/identification/rate_conversion.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "services/core/contract/config_error.hpp"
#include "services/core/contract/tick.hpp"
#include "services/core/identification/polynomial.hpp"
#include "services/core/signal/decompositions.hpp"

namespace stillhand::identification {
namespace {

using Complex = std::complex<double>;

constexpr int kPoints = 201;
constexpr int kIterations = 20;
// Highest order that one polynomial carries at the control rate in double precision: the poles of a
// body lie 0.01 to 0.1 from z = 1, so D(1) falls by that factor with each order while rounding
// stays at 1e-16.  Measured on the simulated rig: error 0.3 % or less to order 8, 3 % and more from
// order 10.
constexpr std::size_t kMaxControlOrder = 8;
// Outside the excited band the model is an extrapolation; a third of the weight there keeps its
// notch in place without spending the excited band's accuracy on it.
constexpr double kOuterWeight = 0.3;

// Response to be met, over the bilinear variable of the control rate, Eq. ID-9.
struct Target {
  std::vector<double> frequency_hz;
  std::vector<double> v;  ///< imaginary part of the variable; 0 to 1
  std::vector<Complex> h;
  std::vector<double> weight;
};

double warp(const ConversionBand& band) {
  return std::tan(std::numbers::pi * band.upper_hz / kControlRateHz);
}

Target target(const DifferenceModel& model, const ConversionBand& band) {
  Target out;
  for (int i = 0; i < kPoints; ++i) {
    const double f = band.upper_hz * i / (kPoints - 1.0);
    const bool excited = f >= band.excited_low_hz && f <= band.excited_high_hz;
    out.frequency_hz.push_back(f);
    out.v.push_back(std::tan(std::numbers::pi * f / kControlRateHz) / warp(band));
    out.h.push_back(signal::response_at(model, f));
    out.weight.push_back(excited ? 1.0 : kOuterWeight);
  }
  return out;
}

// Least squares with real unknowns: two rows a frequency; columns scaled to norm 1.
Eigen::VectorXd solve_real(const Eigen::MatrixXcd& matrix, const Eigen::VectorXcd& right) {
  Eigen::MatrixXd stacked(2 * matrix.rows(), matrix.cols());
  stacked << matrix.real(), matrix.imag();
  Eigen::VectorXd b(2 * right.size());
  b << right.real(), right.imag();
  const Eigen::RowVectorXd norms = stacked.colwise().norm();
  stacked.array().rowwise() /= norms.array();
  const Eigen::VectorXd x = signal::least_squares(stacked, b);
  return (x.array() / norms.transpose().array()).matrix();
}

// One step of Eq. ID-10: w |N - H D| / |D_before| with D(0) = 1; gives the next D.
Polynomial next_denominator(const Target& want, const Polynomial& before, Eigen::Index order) {
  const auto rows = static_cast<Eigen::Index>(want.v.size());
  Eigen::MatrixXcd matrix(rows, 2 * order + 1);
  Eigen::VectorXcd right(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto k = static_cast<std::size_t>(row);
    const Complex v(0.0, want.v[k]);
    const double weight = want.weight[k] / std::abs(signal::polynomial_at(before, v));
    Complex power = weight;
    for (Eigen::Index i = 0; i <= order; ++i) {
      matrix(row, i) = power;
      if (i > 0) matrix(row, order + i) = -want.h[k] * power;
      power *= v;
    }
    right(row) = weight * want.h[k];
  }
  const Eigen::VectorXd x = solve_real(matrix, right);
  Polynomial denominator{1.0};
  denominator.insert(denominator.end(), x.begin() + order + 1, x.end());
  return denominator;
}

// Longest transient of a pole, to 1 % [s]: a body settles within a second.  The fit leaves a slower
// pole only next to a zero, or above its band, where no data constrain it.
constexpr double kSlowestSettle_s = 4.0;

// Distance of such a pole from the imaginary axis of v: |z| = exp(2 warp Re v) near z = 1, and up
// to twice as slow at a quarter of the rate.
double least_decay(double warp) {
  return std::log(100.0) / kSlowestSettle_s / (2.0 * kControlRateHz * warp);
}

// Poles of the left half plane.  None is faster than a quarter of the control rate, where it would
// lie next to z = -1 and ring; none is slower than kSlowestSettle_s.
std::vector<Complex> admissible_poles(const Polynomial& denominator, std::size_t order,
                                      double warp) {
  const double fastest = 1.0 / warp;
  std::vector<Complex> out = roots(denominator);
  for (Complex& pole : out) {
    if (!(pole.real() < 0.0)) pole = -std::conj(pole);
    pole = {std::min(pole.real(), -least_decay(warp)), pole.imag()};
    if (std::abs(pole) > fastest) pole *= fastest / std::abs(pole);
  }
  // A vanished leading coefficient is a pole at infinity.
  out.resize(order, -fastest);
  return out;
}

// Numerator for a given denominator: linear.
Polynomial best_numerator(const Target& want, const Polynomial& denominator) {
  const auto rows = static_cast<Eigen::Index>(want.v.size());
  const auto columns = static_cast<Eigen::Index>(denominator.size());
  Eigen::MatrixXcd matrix(rows, columns);
  Eigen::VectorXcd right(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    const auto k = static_cast<std::size_t>(row);
    const Complex v(0.0, want.v[k]);
    Complex power = want.weight[k] / signal::polynomial_at(denominator, v);
    for (Eigen::Index i = 0; i < columns; ++i, power *= v) matrix(row, i) = power;
    right(row) = want.weight[k] * want.h[k];
  }
  const Eigen::VectorXd x = solve_real(matrix, right);
  return {x.begin(), x.end()};
}

// v = (z - 1) / (warp (z + 1)): poles by themselves, which keeps them inside; the numerator's
// powers by expansion.
DifferenceModel discretised(const Polynomial& numerator, const std::vector<Complex>& poles,
                            double warp) {
  const std::size_t order = poles.size();
  std::vector<Complex> z_poles;
  Complex scale = 1.0;
  for (const Complex& pole : poles) {
    z_poles.push_back((1.0 + warp * pole) / (1.0 - warp * pole));
    scale *= (1.0 - warp * pole) / warp;
  }
  const Polynomial below = from_roots(z_poles);
  Polynomial above(order + 1, 0.0);
  for (std::size_t k = 0; k <= order; ++k) {
    Polynomial term{numerator[k] / std::pow(warp, static_cast<double>(k)) / scale.real()};
    for (std::size_t i = 0; i < order; ++i) term = signal::product(term, {i < k ? -1.0 : 1.0, 1.0});
    for (std::size_t i = 0; i <= order; ++i) above[i] += term[i];
  }
  DifferenceModel out;
  out.rate_hz = kControlRateHz;
  out.numerator.assign(above.rbegin(), above.rend());
  out.denominator.assign(below.rbegin(), below.rend());
  return out;
}

// Eq. ID-11, from the coefficients as they will be used.
void judge(RateConversion& result, const Target& want) {
  double excited_peak = 0.0;
  for (std::size_t k = 0; k < want.h.size(); ++k) {
    if (want.weight[k] == 1.0) excited_peak = std::max(excited_peak, std::abs(want.h[k]));
  }
  for (std::size_t k = 0; k < want.h.size(); ++k) {
    const Complex got = signal::response_at(result.model, want.frequency_hz[k]);
    const double error = std::abs(got - want.h[k]) / excited_peak;
    if (!(error <= result.max_error)) result.max_error = error;
    if (want.weight[k] == 1.0 && !(error <= result.excited_error)) result.excited_error = error;
  }
  if (!signal::is_stable(result.model)) result.max_error = INFINITY;
}

void check(const DifferenceModel& model, const ConversionBand& band) {
  if (!signal::well_formed(model)) {
    throw ConfigError("rate_conversion.model", "a malformed model",
                      "finite coefficients of equal number, the first of the denominator 1");
  }
  if (!signal::is_stable(model)) {
    throw ConfigError("rate_conversion.model", "an unstable model",
                      "every pole inside the unit circle");
  }
  if (!(model.rate_hz >= 2.2 * band.upper_hz)) {
    throw ConfigError("rate_conversion.rate_hz", std::to_string(model.rate_hz),
                      "at least 2.2 times the band's upper edge");
  }
}

double peak_gain(const DifferenceModel& model) {
  double peak = 0.0;
  constexpr int kScan = 2000;
  for (int i = 0; i <= kScan; ++i) {
    const double f = 0.5 * kControlRateHz * std::pow(static_cast<double>(i) / kScan, 2);
    peak = std::max(peak, std::abs(signal::response_at(model, f)));
  }
  return peak;
}

}  // namespace

RateConversion to_control_rate(const DifferenceModel& model, const ConversionBand& band) {
  check(model, band);
  const Target want = target(model, band);
  RateConversion best;
  best.max_error = INFINITY;
  const std::size_t order = std::min(model.order(), kMaxControlOrder);
  Polynomial denominator{1.0};
  for (int i = 0; i < kIterations; ++i) {
    denominator = next_denominator(want, denominator, static_cast<Eigen::Index>(order));
    RateConversion now;
    const std::vector<Complex> poles = admissible_poles(denominator, order, warp(band));
    now.model = discretised(best_numerator(want, from_roots(poles)), poles, warp(band));
    judge(now, want);
    if (now.max_error < best.max_error) best = now;
  }
  if (!(best.max_error <= band.max_error)) {
    throw ConfigError(
        "filter at 1 kHz for this model",
        fmt::format("an error of {:.2f} % of the peak gain", 100.0 * best.max_error),
        fmt::format("at most {:.2f} %; a lower order converts better", 100.0 * band.max_error));
  }
  best.peak_gain = peak_gain(best.model);
  return best;
}

}  // namespace stillhand::identification

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <vector>

namespace stillhand::signal {

/// Linear difference model, README Eq. SG-12 (paper Eq. 3, sign convention as printed):
///
///   f(n) = sum_{i=0..p} c_i a(n-i) - sum_{j=1..p} d_j f(n-j)
///   H(z) = (c_0 + ... + c_p z^-p) / (1 + d_1 z^-1 + ... + d_p z^-p)
///
/// a [m/s^2] platform acceleration + right, f [N] force of the hand on the stick + right, so c_i is
/// in N s^2/m; about -3.2 at 0 Hz.
struct DifferenceModel {
  double rate_hz = 0.0;             ///< [Hz] sample rate, positive
  std::vector<double> numerator;    ///< c_0 .. c_p [N s^2/m]
  std::vector<double> denominator;  ///< 1, d_1 .. d_p [-], as long as the numerator

  /// p [-]; the model must not be empty.
  [[nodiscard]] std::size_t order() const noexcept { return denominator.size() - 1; }
  bool operator==(const DifferenceModel&) const = default;
};

/// True when every number is finite, sizes agree and are at least 1, d_0 is 1, the rate positive.
bool well_formed(const DifferenceModel& model) noexcept;

/// True when every pole lies inside the unit circle, README Eq. SG-13: step-down recursion of
/// Schur and Cohn, every reflection coefficient below 1 in magnitude.  Needs well_formed().
bool is_stable(const DifferenceModel& model);

/// Poles [-] in the z plane, eigenvalues of the companion matrix; size order().
std::vector<std::complex<double>> poles(const DifferenceModel& model);

/// c_0 + c_1 x + ... + c_p x^p by Horner's scheme; 0 without coefficients.
std::complex<double> polynomial_at(const std::vector<double>& c, std::complex<double> x) noexcept;

/// Coefficients of the product of two polynomials.
std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b);

/// H(exp(j 2 pi f / rate)) [N s^2/m], Eq. SG-12.  @param frequency_hz  0 to rate / 2
std::complex<double> response_at(const DifferenceModel& model, double frequency_hz) noexcept;

/// Free run, Eq. SG-12: the force that the model gives for the acceleration alone, from rest.
/// Same length as the input.
std::vector<double> simulated(const DifferenceModel& model,
                              const std::vector<double>& acceleration_m_s2);

}  // namespace stillhand::signal

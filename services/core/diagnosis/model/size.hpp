// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/core/diagnosis/model/model.hpp"
#include "services/core/diagnosis/model/signals.hpp"

/// Physical numbers of an effect, METHOD "Sizes".  Pure.
namespace stillhand::diagnosis {

/// One number that a reader quotes.
struct Size {
  std::string name;  ///< for example "friction_force"
  std::string unit;  ///< as a recording's header has it; "-": a pure number
  double value = 0.0;
  std::string meaning = {};          ///< a clause; empty: the name says it
  std::optional<double> at_hz = {};  ///< [Hz] of a frequency response
  /// Eq. DG-71; NaN: given or searched, or the samples do not determine it.
  double std_error = std::numeric_limits<double>::quiet_NaN();
  std::string origin = "derived";  ///< or "fitted", "searched", "given"
};

/// What a kind makes its sizes of.  The numbers of the model may move; the rest is held.
struct SizeCase {
  const Model& model;
  std::size_t which;  ///< of model.effects
  const Signals& signals;
  double centre_hz = 0.0;  ///< [Hz] of the band of what drives the effect, Eq. DG-72
  /// Of z, Eq. DG-4: the largest that was seen; inside the body over |N| at centre_hz, so that it
  /// keeps its meaning while N moves.
  double largest_argument = 0.0;

  [[nodiscard]] const Effect& effect() const { return model.effects[which]; }
};

/// sum_i c_i q^-i at a frequency; 0 Hz: its sum.
std::complex<double> polynomial_at(const std::vector<double>& c, double frequency_hz,
                                   double rate_hz);
/// sum_i d_i D^i, D = 1 - q^-1.
std::complex<double> difference_polynomial_at(const std::vector<double>& d, double frequency_hz,
                                              double rate_hz);
/// Response of a path through the body's poles, Eq. DG-6.
std::complex<double> through_body_at(const SizeCase& at, double frequency_hz);

/// Largest |x - centre| over the samples that weigh.
double largest_deflection(const std::vector<double>& x, double centre, const Signals& signals);

/// "N/(m/s^2)"; "-" where both are the same or none.
std::string unit_over(std::string_view over, std::string_view under);
bool is_plain_unit(std::string_view unit);

}  // namespace stillhand::diagnosis

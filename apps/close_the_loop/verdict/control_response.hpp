// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <functional>
#include <vector>

#include "apps/close_the_loop/verdict/control_model.hpp"
#include "services/core/diagnosis/model/model.hpp"

/// A diagnosed model's linear parts at the control rate, METHOD Eq. CL-1 and CL-2.
namespace stillhand::close_the_loop {

using Response = std::function<std::complex<double>(double frequency_hz)>;

/// sum c_i exp(-j w i).
std::complex<double> polynomial_at(const std::vector<double>& c, double turn_rad);

/// Denominators to try, in this order: Eq. CL-1, then, because a pole may have no equal at the new
/// rate (a real one left of 0 turns by half the old rate), those of a fit to the response of the
/// body, and of body and modes together (identification ID-9).  Where the input is late, each with
/// four poles more (Pade), if there is room for them.
std::vector<std::vector<double>> possible_denominators(const diagnosis::Model& model);

/// Response of the body alone from input k.
std::complex<double> body_response(const diagnosis::Model& model, std::size_t k,
                                   double frequency_hz);
/// Response of the modes next to the body from input k; 0 without any.
std::complex<double> mode_response(const diagnosis::Model& model, std::size_t k,
                                   double frequency_hz);
/// True when there are modes next to the body.
bool has_modes(const diagnosis::Model& model);

/// [s] that the input needs to reach the body, Eq. DG-20; 0 without such an effect.
double input_delay_s(const diagnosis::Model& model);

/// A numerator, and how well it meets the response.
struct NumeratorFit {
  std::vector<double> numerator;  ///< c_0 .. c_p
  double error = 0.0;             ///< [-] largest in the band, over the largest response there
};

/// Eq. CL-8: the numerator over a denominator of the control rate that answers an input that is
/// held from each of the model's samples to the next as c / a at the model's rate answers the
/// samples. Exact where the denominator's poles are those of Eq. CL-1.
/// @param ticks  of a sample of the model
/// @param late   c_0 is 0
NumeratorFit held_numerator(const std::vector<double>& denominator, const std::vector<double>& c,
                            const std::vector<double>& a, std::size_t ticks, bool late);

/// Eq. CL-2: the numerator over a denominator of the control rate that comes nearest to a response.
/// @param late  c_0 is 0
NumeratorFit fit_numerator(const std::vector<double>& denominator, const Response& wanted,
                           bool late, const ControlOptions& options);

}  // namespace stillhand::close_the_loop

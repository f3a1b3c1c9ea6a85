// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// Where the conversion has to be good.
struct ConversionBand {
  double excited_low_hz = 0.7;   ///< [Hz] paper III-A, identification motion
  double excited_high_hz = 4.0;  ///< [Hz]
  double upper_hz = 10.0;        ///< [Hz] edge of the preprocessing filter; fit and check end here
  double max_error = 0.05;       ///< [-] a larger Eq. ID-11 over 0 .. upper_hz is refused
};

/// A model for the canceller's rate.
struct RateConversion {
  DifferenceModel model;       ///< at kControlRateHz, stable
  double max_error = 0.0;      ///< Eq. ID-11 over 0 .. upper_hz [-]
  double excited_error = 0.0;  ///< Eq. ID-11 over the excited band [-]
  double peak_gain = 0.0;      ///< largest |H| from 0 to 500 Hz [N s^2/m]
};

/// Carries a model identified at a low rate to 1 kHz, METHOD Eq. ID-9 to ID-11.  A rational
/// function of the same order in the bilinear variable of the *control* rate,
///
///   v(f) = j tan(pi f / 1000 Hz) / tan(pi upper / 1000 Hz),
///
/// is fitted to the model's own response over 0 .. upper_hz (Levy's least squares iterated after
/// Sanathanan and Koerner), unstable poles mirrored, and v replaced by (z-1)/(z+1): because the fit
/// is made in the warped variable, the bilinear step itself adds no error.
/// Error, Eq. ID-11: max |H_1000(f) - H(f)| / max_{excited} |H(f)|, from the final coefficients.
/// Source: Levy, IRE Trans. AC-4, 1959; Sanathanan and Koerner, IEEE Trans. AC-8, 1963.  Pure.
/// @throws stillhand::ConfigError when the model isn't well formed or stable, its rate is below
/// 2.2 upper_hz, or the error exceeds band.max_error.
RateConversion to_control_rate(const DifferenceModel& model, const ConversionBand& band = {});

}  // namespace stillhand::identification

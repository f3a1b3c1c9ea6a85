// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// Where the power of a signal lies, METHOD Eq. DG-65.  Pure.
namespace stillhand::diagnosis {

/// All but a hundredth of a signal's power on each side, about its mean.
struct ExcitedBand {
  std::string of;        ///< name of the signal
  double low_hz = 0.0;   ///< [Hz]
  double high_hz = 0.0;  ///< [Hz]
};

/// @param values   [samples], any unit
/// @param mean     of the values
/// @param rate_hz  [Hz] of the samples, above 0
ExcitedBand excited_band(std::string name, const std::vector<double>& values, double mean,
                         double rate_hz);

/// [-] of a signal's power about its mean that lies below or above a band; 0 for a constant.
double power_outside(const ExcitedBand& band, const std::vector<double>& values, double mean,
                     double rate_hz);

}  // namespace stillhand::diagnosis

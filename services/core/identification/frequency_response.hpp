// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// One point of a Bode plot, METHOD Eq. ID-8.
struct ResponsePoint {
  double frequency_hz;  ///< [Hz]
  double magnitude_db;  ///< 20 log10 |H| [dB re 1 N s^2/m]; -infinity at an exact zero
  double phase_deg;     ///< [deg] in (-180, 180]
};

/// Response of a model (services/core/signal Eq. SG-12) at the given frequencies [Hz], each from 0
/// to rate / 2; the paper's Figs 4 and 6 show it.  Pure.
std::vector<ResponsePoint> frequency_response(const DifferenceModel& model,
                                              const std::vector<double>& frequencies_hz);

/// `count` frequencies from low_hz to high_hz, evenly spaced in log frequency; count >= 2.
std::vector<double> log_spaced_hz(double low_hz, double high_hz, int count);

}  // namespace stillhand::identification

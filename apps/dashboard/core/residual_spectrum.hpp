// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "apps/dashboard/core/force_record.hpp"

namespace stillhand::dashboard {

/// Power densities of the hand's force and of its residual, METHOD Eq. DB-6; lines above 0 Hz.
struct ResidualSpectrum {
  std::vector<double> frequency_hz;       ///< [Hz] up to 50
  std::vector<double> force_n2_hz;        ///< [N^2/Hz]
  std::vector<double> residual_n2_hz;     ///< [N^2/Hz]
  double force_rms_n = 0.0;               ///< [N] of these lines
  double residual_rms_n = 0.0;            ///< [N]
  double length_s = 0.0;                  ///< [s] of the record
  std::size_t segments = 0, bridged = 0;  ///< [-], [ticks]
};

/// Eq. DB-6: Welch (signal/spectrum.hpp, Eq. SG-8) with segments of 4.096 s over all that is there.
/// Empty while that is shorter than one segment.  Pure.
ResidualSpectrum residual_spectrum(const ForceRecord& record);

}  // namespace stillhand::dashboard

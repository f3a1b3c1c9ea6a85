// SPDX-License-Identifier: Apache-2.0
#include "apps/dashboard/core/residual_spectrum.hpp"

#include <cmath>

#include "services/core/signal/spectrum.hpp"

namespace stillhand::dashboard {

namespace {

constexpr double kRate_hz = 1000.0;
constexpr double kHighest_hz = 50.0;
constexpr std::size_t kSegment = 4096;

}  // namespace

ResidualSpectrum residual_spectrum(const ForceRecord& record) {
  ResidualSpectrum found;
  const ForceRecord::Signals signals = record.newest();
  found.length_s = static_cast<double>(signals.force_n.size()) / kRate_hz;
  found.bridged = signals.bridged;
  if (signals.force_n.size() < kSegment) return found;
  found.segments = (signals.force_n.size() - kSegment) / (kSegment / 2) + 1;
  const signal::CrossSpectra spectra =
      signal::cross_spectra(signals.force_n, signals.residual_n, kRate_hz, kSegment);
  const double width_hz = spectra.frequency_hz[1];
  for (std::size_t k = 1; spectra.frequency_hz[k] <= kHighest_hz; ++k) {
    found.frequency_hz.push_back(spectra.frequency_hz[k]);
    found.force_n2_hz.push_back(spectra.s_xx[k]);
    found.residual_n2_hz.push_back(spectra.s_yy[k]);
    found.force_rms_n += spectra.s_xx[k] * width_hz;
    found.residual_rms_n += spectra.s_yy[k] * width_hz;
  }
  found.force_rms_n = std::sqrt(found.force_rms_n);
  found.residual_rms_n = std::sqrt(found.residual_rms_n);
  return found;
}

}  // namespace stillhand::dashboard

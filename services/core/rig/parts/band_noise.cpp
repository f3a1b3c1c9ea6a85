// SPDX-License-Identifier: Apache-2.0
#include "services/core/rig/parts/band_noise.hpp"

#include <cmath>

#include "services/core/contract/tick.hpp"

namespace stillhand::rig {
namespace {

constexpr int kOrder = 4;

/// Square root of the energy of the impulse response.  The slowest pole of the high-pass is 22.5
/// degrees from the imaginary axis; it decays to exp(-2 pi 0.38 8) = 5e-9 after eight periods.
double impulse_norm(signal::Butterworth high_pass, signal::Butterworth low_pass, double low_hz) {
  const auto samples = static_cast<int>(8.0 * kControlRateHz / low_hz);
  double energy = 0.0;
  for (int n = 0; n < samples; ++n) {
    const double h = low_pass.step(high_pass.step(n == 0 ? 1.0 : 0.0));
    energy += h * h;
  }
  return std::sqrt(energy);
}

}  // namespace

BandNoise::BandNoise(std::uint64_t seed, std::uint64_t stream, const Band& band)
    : noise_(seed, stream),
      high_pass_(kOrder, band.low_hz, kControlRateHz, signal::Passband::kHigh),
      low_pass_(kOrder, band.high_hz, kControlRateHz),
      gain_(band.rms / impulse_norm(high_pass_, low_pass_, band.low_hz)) {}

}  // namespace stillhand::rig

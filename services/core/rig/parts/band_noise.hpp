// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "services/core/rig/parts/sensor_noise.hpp"
#include "services/core/signal/butterworth.hpp"

namespace stillhand::rig {

/// Seeded normal noise between two frequencies at 1 kHz (Butterworth, order 4 at each edge), with a
/// given long-term RMS R:
///
///   y = R h * n / |h|,   n white noise of unit variance, h the impulse response of the filters
///
/// Source: filters after Eq. SG-4 (services/core/signal); noise after METHOD Eq. RG-11.
/// Never allocates or throws after construction.
class BandNoise {
 public:
  struct Band {
    double low_hz;
    double high_hz;
    double rms;  ///< unit of the output
  };
  BandNoise(std::uint64_t seed, std::uint64_t stream, const Band& band);

  double step() noexcept { return gain_ * low_pass_.step(high_pass_.step(noise_())); }

 private:
  SensorNoise noise_;
  signal::Butterworth high_pass_;
  signal::Butterworth low_pass_;
  double gain_;
};

}  // namespace stillhand::rig

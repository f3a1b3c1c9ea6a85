// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "services/core/next_run/contest.hpp"
#include "tests/unit/diagnosis/made_measurement.hpp"

/// A static body and a force of x, or of z: square waves of 2, 4 and 8 samples, which are
/// orthogonal.
namespace stillhand::next_run::made {

inline constexpr double kGain = 0.3;

inline std::vector<double> square_wave(std::size_t count, std::size_t period) {
  std::vector<double> wave(count);
  for (std::size_t n = 0; n < count; ++n) wave[n] = n % period < period / 2 ? 1.0 : -1.0;
  return wave;
}

/// y = 2 u + kGain x + white noise, times `scale`.  @param z_period  4: z is x
inline diagnosis::Measurement measured(std::size_t count, std::size_t z_period, std::uint64_t seed,
                                       double scale = 1.0) {
  std::vector<double> y = diagnosis::made::white(count, seed);
  const std::vector<double> u = square_wave(count, 2);
  const std::vector<double> x = square_wave(count, 4);
  for (std::size_t n = 0; n < count; ++n) y[n] = scale * (y[n] + 2.0 * u[n] + kGain * x[n]);
  return diagnosis::made::measurement_of({{"u", "m/s^2", u},
                                          {"x", "-", x},
                                          {"z", "-", square_wave(count, z_period)},
                                          {"y", "N", std::move(y)}});
}

inline Candidate candidate(const char* channel, double scale = 1.0) {
  const diagnosis::Body body{.numerators = {{2.0 * scale}}};
  return {diagnosis::made::model_of(body,
                                    {{"coupled_input", "static", {channel}, {}, {kGain * scale}}}),
          0, 1.0};
}

/// The recording in which z is x: a tie.
inline Contest tied(double scale = 1.0) {
  return {{candidate("x", scale), candidate("z", scale)},
          diagnosis::Signals(measured(3300, 4, 1, scale), {"u"}, "y")};
}

}  // namespace stillhand::next_run::made

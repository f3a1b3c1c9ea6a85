// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/diagnosis/core/measurement.hpp"

namespace stillhand::diagnosis {

/// Samples that the engine works on at most.
inline constexpr std::size_t kMostSamples = 80'000;

/// A measurement as the engine works on it: at a rate of at least twenty times the highest
/// frequency that the inputs excite (100 Hz at least), and of a long record a number of pieces
/// evenly spread over it, kMostSamples in all.  Notes say what was done.
///
/// A rate above that is decimated by a whole number, every channel alike, after a low-pass of order
/// 8 (Butterworth) at 0.4 of the new rate, forwards and backwards so that nothing is delayed.
/// @param inputs  names of the channels whose band counts; those that aren't there are passed over
Measurement working_set(const Measurement& measurement, const std::vector<std::string>& inputs);

/// How many of its samples are one at `rate_hz`.
/// @throws stillhand::ConfigError when that is no whole number.
std::size_t rate_factor(const Measurement& measurement, double rate_hz);

/// Every stretch at a whole fraction of the rate, as above.  @param factor  2 or more
Measurement decimated(const Measurement& measurement, std::size_t factor);

}  // namespace stillhand::diagnosis

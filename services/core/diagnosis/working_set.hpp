// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "services/core/diagnosis/record/measurement.hpp"

namespace stillhand::diagnosis {

/// Largest number of samples that the engine uses.
inline constexpr std::size_t kMostSamples = 80'000;

/// Pieces of equal length, evenly spread over stretches, `most` samples in all; none reaches over a
/// stretch's end.
std::vector<Stretch> spread_pieces(const std::vector<Stretch>& stretches, std::size_t pieces,
                                   std::size_t most, double rate_hz);

/// A measurement as the engine uses it: at a rate of at least twenty times the highest frequency
/// that the inputs excite (at least 100 Hz); from a long record a number of pieces evenly spread
/// over it, kMostSamples in all.  Notes report both.
///
/// A rate above that is decimated by a whole number, every channel alike, after a low-pass of order
/// 8 (Butterworth) at 0.4 of the new rate, forwards and backwards so that nothing is delayed.
/// @param inputs  names of the channels whose band counts; those that are missing are ignored
Measurement working_set(const Measurement& measurement, const std::vector<std::string>& inputs);

/// Number of its samples in one sample at `rate_hz`.
/// @throws stillhand::ConfigError when that is not a whole number.
std::size_t rate_factor(const Measurement& measurement, double rate_hz);

/// Every stretch at a whole fraction of the rate, as above.  @param factor  2 or more
Measurement decimated(const Measurement& measurement, std::size_t factor);

}  // namespace stillhand::diagnosis

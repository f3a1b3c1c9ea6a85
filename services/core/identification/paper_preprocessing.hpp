// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "services/core/identification/record.hpp"

namespace stillhand::identification {

/// Rate of a recording in the paper [Hz], and of its fit; III-A.
inline constexpr double kRecordingRateHz = 100.0;
/// A clock may be a thousandth slow: its recording counts as one of 100 Hz.
inline constexpr double kLeastRecordingRateHz = 0.999 * kRecordingRateHz;
inline constexpr double kFitRateHz = 50.0;

/// Paper III-A, METHOD Eq. ID-5: to 100 Hz, fifth-order Butterworth low-pass at 10 Hz, every second
/// sample, 50 Hz.  A record above 100 Hz first passes an anti-alias filter (Butterworth, order 8,
/// 40 Hz: -43 dB at 75 Hz and more above) and is decimated, or resampled with a windowed sinc when
/// its rate is no multiple of 100 Hz.  Both channels pass the same filters, so the response between
/// them stays as it was.
/// Pure.  The first second holds the filters' own transient.
/// @param recorded  100 Hz or more, at least one second
/// @throws stillhand::ConfigError for a lower rate, a short record, or as check().
Record preprocessed(const Record& recorded);

}  // namespace stillhand::identification

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::diagnosis {

/// One measured signal.
struct Channel {
  std::string name;            ///< without its unit, for example "a_y"
  std::string unit;            ///< for example "m/s^2"
  std::vector<double> values;  ///< one a sample, finite
};

/// Samples [first, end) that follow each other without a gap; what came before is unknown.
struct Stretch {
  std::size_t first = 0;
  std::size_t end = 0;
  double start_s = 0.0;       ///< [s] time of `first`
  std::size_t recording = 0;  ///< which of the recordings that were joined
};

/// What the screening of a recording's rows found in one channel, before they came onto the grid.
struct SampleFault {
  std::string channel;
  std::string what;             ///< "held", "stuck", "clipped", "spikes", "sentinel", ...
  std::vector<double> times_s;  ///< [s] where it begins, the first ten places
  double share = 0.0;           ///< [-] of the rows
  std::string says;             ///< one sentence: what it is, and what was left out
  bool unsound = false;         ///< a model of this channel means nothing
};

/// [-] of a channel's rows at a limit.  Of Gauss' noise a limit lets through 1 - p of the gain, p
/// the share of the rows at it (Bussgang, 1952); a filter may miss by a twentieth (max_error of
/// rate_conversion).
inline constexpr double kMostClipped = 0.05;

/// Measured channels on one uniform grid, with a stretch for every run without a long gap.  Samples
/// of a short gap are filled in by interpolation, so that a simulation can run through them; their
/// weight is 0.
struct Measurement {
  std::string source;  ///< for messages and reports, usually the file
  double rate_hz = 0.0;
  std::vector<Channel> channels;   ///< each of size() values
  std::vector<Stretch> stretches;  ///< in order, not overlapping, together all samples
  std::vector<double> weight;      ///< [-] 1: measured, 0: filled in; size()
  std::vector<std::string> notes;  ///< what the reader did, a sentence each (gaps, resampling, ...)

  std::vector<SampleFault> screening = {};

  [[nodiscard]] std::size_t size() const noexcept { return weight.size(); }
  /// Channel of that name, or nullptr.
  [[nodiscard]] const Channel* find(std::string_view name) const noexcept;
  /// [s] time of a sample.
  [[nodiscard]] std::vector<double> time_s() const;
};

/// Why no model of these channels means anything, by the screening; empty: nothing speaks against
/// it.
std::string why_unsound(const Measurement& measurement, const std::vector<std::string>& channels);

/// @throws stillhand::ConfigError when sizes disagree, a value is not finite (names channel and
/// sample), the rate is not positive or the stretches do not cover the samples.
void check(const Measurement& measurement);

}  // namespace stillhand::diagnosis

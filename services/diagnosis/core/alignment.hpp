// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace stillhand::diagnosis {

/// Clock of the output against the input's: at t the output answers the input of t - delay_s(t).
struct Alignment {
  double lag_s = 0.0;     ///< [s] in the middle of the record; below 0: the output leads
  double drift = 0.0;     ///< [s/s] by which the lag grows
  double middle_s = 0.0;  ///< [s] from the first sample

  [[nodiscard]] double delay_s(double time_s) const noexcept {
    return lag_s + drift * (time_s - middle_s);
  }
};

/// METHOD Eq. DG-77: the lag and its drift at which the correlations of the record's segments add
/// up to most, whatever the body between them.  Pure.
///
///   max over (L, d) of | sum_s c_s(L + d (t_s - T/2)) |,  c_s(l) = sum_{t in s} y(t) x(t - l)
///
/// |L| to the smaller of 10 s and a quarter of the record, |d| to 0.02.
/// @param x, y  one length, at rate_hz; at least 8 s
Alignment aligned(const std::vector<double>& x, const std::vector<double>& y, double rate_hz);

/// What to try of it: a body lags by itself, which the correlations don't tell from the clock, so
/// that its part, 0 to 0.15 s, is left to the body.  Empty: nothing but a body's lag.
std::vector<Alignment> readings(const Alignment& found);

/// x as the output's clock sees it; the ends are held.
std::vector<double> moved(const std::vector<double>& x, double rate_hz, const Alignment& by);

/// "the output leads the input by 2 s", "two clocks 8300 ppm apart, and ..."
std::string in_words(const Alignment& alignment);

/// [-] of the output's power that an alignment must leave to be looked for: a model that explains
/// more than nine tenths has no other clock.
inline constexpr double kAlignmentGate = 0.1;
/// [-] of the squared error that another reading of the recording must leave at most.
inline constexpr double kBetterReading = 0.5;

}  // namespace stillhand::diagnosis

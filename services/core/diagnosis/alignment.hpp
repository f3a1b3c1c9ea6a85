// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
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

/// METHOD Eq. DG-78: the lag and its drift at which the correlations of the record's segments add
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

/// Whether the lag grows by more than a 25th of a period over half of the record.
bool drifts(const Alignment& found);

/// x as the output's clock sees it; the ends are held.
std::vector<double> moved(const std::vector<double>& x, double rate_hz, const Alignment& by);

/// "the output leads the input by 2 s", "two clocks 8300 ppm apart, and ..."
std::string in_words(const Alignment& alignment);

/// "f leads a_y, or the columns are swapped: ..."
/// @param back  [-] of the input that the output explains
/// @param here  [-] of the output that the input explains
std::string swapped_in_words(const std::string& input, double back, const std::string& output,
                             double here);
/// "f leads a_y by 0.04 s or more: ..."
/// @param with  [-] of the output that a model leaves that knows the input so far ahead
/// @param left  [-] that the model leaves
std::string lead_in_words(const std::string& input, const std::string& output, double lead_s,
                          double with, double left);

/// The line y = gain x + level of least squares.
struct Likeness {
  double gain = 0.0;
  double share = 0.0;  ///< [-] of y's power about its mean that the line has
};
Likeness likeness(const std::vector<double>& x, const std::vector<double>& y);

/// [-] between gains that one unit does not join.  Persons differ by a factor of two or three
/// (paper, table I); units by 4.45 (lbf) and more.
inline constexpr double kAnotherUnit = 4.0;

/// [-] of the power that noise leaves of a line through two sensors' samples at least: 1e-3 of the
/// size, where the phases of their filters alone differ by more in a hand's band.
inline constexpr double kTwoSensors = 1e-6;
/// Why two channels are one: "f is a constant times a_y: one sensor twice?"; empty: they are two.
std::string one_sensor_twice(const std::string& input, const std::vector<double>& x,
                             const std::string& output, const std::vector<double>& y);

/// [kg] Twice a person on a seat, Eq. DG-80.
inline constexpr double kHeaviestHand_kg = 200.0;

/// What an acceleration explains of a force.
struct Motion {
  std::string input;
  std::string input_unit;
  double input_m_s2 = 0.0;  ///< [m/s^2] RMS about the mean
  std::string output;
  std::string output_unit;
  double explained_n = 0.0;  ///< [N] RMS
  double heaviest_kg = kHeaviestHand_kg;
};

/// METHOD Eq. DG-80: why the two can't be of one body, by the mass that their ratio is; empty: they
/// can, or are not in m/s^2 and N.
std::string unlikely_mass(const Motion& motion);
/// "units not checked, because ..."; empty: unlikely_mass() checks these.
std::string why_unchecked(const Motion& motion);

/// [-] of the output's power that a model must leave for another clock to be looked for.
inline constexpr double kAlignmentGate = 0.01;
/// [-] of the squared error that another clock must leave at most: a fifth.  On a position that an
/// integrator holds (a servo), a drift that is none left a quarter.
inline constexpr double kBetterClock = 0.2;

/// METHOD Eq. DG-81: leads [s] of the output over the input that are tried.  A body's output
/// follows its input, so that a model that knows the input's future explains no more; one of an
/// exchanged input and output, which a differentiator joins, does.
inline constexpr std::array<double, 2> kLeads_s{0.04, 0.08};
/// [-] of the output's power that a model must leave for a lead to be looked for: 0.3 % of its
/// size.
inline constexpr double kLeadGate = 1e-5;
/// [-] of the squared error that the future must leave at most.  Measured recordings left 0.27 (a
/// damper under one sinusoid) and more, exchanged columns 0.06 and less.
inline constexpr double kBetterLead = 0.1;

}  // namespace stillhand::diagnosis

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace stillhand::measurement {

/// Rows [first, end).
struct Place {
  std::size_t first = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t rows() const noexcept { return end - first; }
};

/// Bad rows of one column.
struct BadRows {
  std::string what;
  std::vector<Place> places;  ///< in order
  std::string detail;         ///< the value, "32767"

  [[nodiscard]] std::size_t rows() const noexcept;
};

/// Runs of equal values, those of one row included; none where they could show nothing: no run has
/// three rows, and fewer than a quarter of the rows repeat the one before.
std::vector<Place> equal_runs(const std::vector<double>& values);

/// More than 16 values: fewer are a state or a switch, which no range and no noise describes.
bool has_many_levels(const std::vector<double>& values);

/// The tests of one column of many levels, README ME-7 to ME-15.  Pure; linear in the rows.
/// @param values  at least 200
std::vector<BadRows> far_values(const std::vector<double>& values);
/// @param quiet  asked of a place and its two neighbours: does no other channel jump there?
std::optional<BadRows> spikes_in(const std::vector<double>& values, double rate_hz,
                                 const std::function<bool(const Place&)>& quiet);
/// @param should_move  asked of a place: would a sound channel have moved there?
/// A rest may jitter by two of the channel's last digits.
std::optional<BadRows> stuck_in(const std::vector<double>& values, double rate_hz,
                                const std::function<bool(const Place&)>& should_move);
std::optional<BadRows> clipped_in(const std::vector<double>& values,
                                  const std::vector<Place>& runs);
std::optional<BadRows> dropped_in(const std::vector<double>& values, double rate_hz);
/// Rows for which a value is held, on the mean; 0: it is not held.
double held_rows(const std::vector<double>& values, const std::vector<Place>& runs, double rate_hz);
/// The same of values held (`order` 1) or straight lines (2) behind a noise: over the rows, the
/// squares of the first or second differences are then a comb.  From 8 Hz on; of 32,768 rows.
double comb_rows(const std::vector<double>& values, int order, double rate_hz);
/// Rows, on the mean, for which values are held unevenly behind a noise; 0: they are not.  Steps
/// above 2.2 deviations of the usual ones are then many, and alone.  Of 32,768 rows.
double uneven_rows(const std::vector<double>& values, double rate_hz);
/// Rows from knot to knot of straight lines, as an interpolation from a lower rate leaves them; 0:
/// there are none.
double straight_rows(const std::vector<double>& values, double rate_hz);
/// [-] of the variance, by which chords over so many rows are off: D^2/120 on the mean, D the bend
/// over the rows of one; a row's bend is D/rows.
double chord_error(const std::vector<double>& values, double rows);
bool counts_rows(const std::vector<double>& values);
/// Rows at which whole numbers have left one end of their range and go on at the other.
std::vector<Place> overflows(const std::vector<double>& values);
/// Levels of a channel of few, whose rounding is a hundredth of its variance or more; 0: it is
/// less.
std::size_t coarse_levels(const std::vector<double>& values);

/// Size of the step to a row; of the steps between unequal rows, the median.
double step_to(const std::vector<double>& values, std::size_t row);
double usual_step(const std::vector<double>& values, const std::vector<Place>& runs);
/// About the mean.
double deviation_of(const std::vector<double>& values);
/// A source that beats, as footfalls do, and no disturbance of a wire.
bool beat(const std::vector<Place>& places);

/// Places of one or two rows that leave the line between their neighbours by 25 of `usual` or more,
/// where the rows on both sides go on into each other.
/// @param usual  as usual_off_neighbours()
std::vector<Place> jumps_out_and_back(const std::vector<double>& values, double usual,
                                      double rate_hz);

/// Eq. ME-8: how far a row lies from the cubic through its four neighbours, and how far the rows of
/// the channel usually do.
double above_neighbours(const std::vector<double>& values, std::size_t row);
double off_neighbours(const std::vector<double>& values, std::size_t row);  ///< its size
/// 1.48 times the median of the above, which is one standard deviation of a normal one; 0 where
/// half of the rows lie on the cubic.
double usual_off_neighbours(const std::vector<double>& values);

}  // namespace stillhand::measurement

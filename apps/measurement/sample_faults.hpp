// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace stillhand::measurement {

/// Rows [first, end) of equal values.
struct EqualRun {
  std::size_t first = 0;
  std::size_t end = 0;

  [[nodiscard]] std::size_t rows() const noexcept { return end - first; }
};

std::vector<EqualRun> equal_runs(const std::vector<double>& values);

/// Bad rows of one column.
struct BadRows {
  std::string what;
  std::vector<EqualRun> places;  ///< in order
  std::string detail;            ///< "32767", "25 Hz"

  [[nodiscard]] std::size_t rows() const noexcept;
};

/// The tests of one column, each on what the ones before it left, README ME-5 to ME-10.  Pure.
/// @param values  at least 2
/// @param is_bad  rows that are known to be bad; the found ones are added
std::vector<BadRows> far_values(const std::vector<double>& values, std::vector<char>& is_bad);
std::optional<BadRows> spikes_in(const std::vector<double>& values, std::vector<char>& is_bad);
std::optional<BadRows> stuck_in(const std::vector<double>& values,
                                const std::vector<EqualRun>& runs, double rate_hz, bool rests,
                                std::vector<char>& is_bad);
std::optional<BadRows> clipped_in(const std::vector<double>& values,
                                  const std::vector<EqualRun>& runs,
                                  const std::vector<char>& is_bad);
/// Rows a value is held for, on the mean; 0: it is not held.
double held_rows(const std::vector<double>& values, const std::vector<EqualRun>& runs);
bool counts_rows(const std::vector<double>& values);

}  // namespace stillhand::measurement

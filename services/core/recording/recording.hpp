// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace stillhand::recording {

/// One measured channel.
struct Column {
  std::string name;            ///< without its unit, for example "a_y"
  std::string unit;            ///< text between the brackets, for example "m/s^2"
  std::vector<double> values;  ///< one for each row, finite
};

/// Missing rows between two rows.
struct Gap {
  std::size_t after_row;      ///< row before the gap, from 0
  std::int64_t missing_rows;  ///< [-] number of rows by the sample period, at least 1
};

/// A table of samples over time, as in a CSV file (README, "CSV").
struct Recording {
  std::string source;             ///< name for messages, usually the file
  std::vector<double> time_s;     ///< [s] strictly increasing
  std::vector<Column> columns;    ///< every other column, in the order of the file
  double rate_hz = 0.0;           ///< [Hz] set by estimate_timing()
  std::vector<Gap> gaps;          ///< in order
  std::size_t repeated_rows = 0;  ///< [-] of the file, equal to an earlier row and left out

  [[nodiscard]] std::size_t row_count() const noexcept { return time_s.size(); }
  /// Column of that name, or nullptr.
  [[nodiscard]] const Column* find(std::string_view name) const noexcept;
};

/// Computes rate_hz and gaps from time_s:
///
///   T = mean of the steps between 0.5 and 1.5 times the median step,  rate = 1/T
///   step > 1.5 T is a gap of round(step/T) - 1 rows
/// The mean removes the rounding of printed times (128 Hz printed in ms has steps of 7 and 8 ms).
/// The median excludes gaps from the mean.  Needs 2 rows.  Source: README Eq. RC-1 and RC-2.
void estimate_timing(Recording& recording);

}  // namespace stillhand::recording

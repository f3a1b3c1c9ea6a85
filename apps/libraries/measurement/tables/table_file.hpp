// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace stillhand::measurement {

/// One column of a file, before its values are read.
struct ColumnHead {
  std::string title;            ///< as in the file
  std::string name;             ///< without its unit
  std::string unit;             ///< empty: the file states none
  std::size_t rows = 0;         ///< [-] 0: not known yet
  std::string angle_unit = {};  ///< of a file that states one for all its angles
  std::string unit_below = {};  ///< of a line of units, where it contradicts the title's; or empty
  std::size_t unit_line = 0;    ///< number of that line
};

/// What a file states about its columns.
struct TableHead {
  std::string path;
  std::string form;  ///< "CSV with ';' between columns and ',' as decimal sign"
  std::vector<ColumnHead> columns;
  double rate_hz = 0.0;    ///< [Hz] stated by the file; 0: none
  bool has_times = false;  ///< its rows have times of their own, which no column holds
  std::vector<std::string> notes;
  std::string loss = {};  ///< of a damaged file, as far as it was read; empty: nothing is lost
};

/// Where the stamps of a file go back; time goes on in the rows, with a gap.
struct BackStep {
  double time_s = 0.0;  ///< [s] of the last row before it
  double back_s = 0.0;  ///< [s]
};

/// Values of the columns that were asked for, in that order.
struct RawColumns {
  std::vector<double> time_s;               ///< [s] empty unless `has_times`
  std::vector<std::vector<double>> values;  ///< of one length; NaN: the row has no such value
  std::vector<std::string> notes;
  std::vector<BackStep> back_steps = {};
};

/// A file with columns of numbers, of any kind.  The head is read first: it decides which columns
/// are worth reading.
class TableFile {
 public:
  /// Titles and units come out of the file: '?' replaces their control characters, before any of
  /// them reaches a terminal.
  explicit TableFile(TableHead head);
  virtual ~TableFile() = default;
  TableFile(const TableFile&) = delete;
  TableFile& operator=(const TableFile&) = delete;

  [[nodiscard]] const TableHead& head() const noexcept { return head_; }
  /// @param columns  numbers in head().columns
  /// @throws stillhand::ConfigError naming the place of a value that is no number.
  virtual RawColumns read(const std::vector<std::size_t>& columns) = 0;
  /// Place of a row of the last read(), for messages.
  [[nodiscard]] virtual std::string place(std::size_t row) const {
    return head_.path + ", row " + std::to_string(row + 1);
  }

 protected:
  /// Damage may show only where the values lie.
  void set_loss(std::string line) { head_.loss = std::move(line); }

 private:
  TableHead head_;
};

/// Signs of a text table; 0: found by its content.
struct TextForm {
  char separator = 0;  ///< ',', ';', a tab or ' ' (any number of blanks)
  char decimal = 0;    ///< '.' or ','
};

enum class FileKind { kText, kMcap, kMatlab, kHdf5, kSound, kXdf, kTdms };

/// Kind of a file by its first bytes; of a binary file without any, by its name.
/// @throws stillhand::ConfigError if it cannot be read, or is of a kind that must be converted:
/// then
///         with the line that does it
FileKind kind_of(const std::string& path);

/// Opens a file of any kind.
/// @param most_values  [-] rows times columns that may be read
/// @throws stillhand::ConfigError if it cannot be read, or holds no column of numbers.
std::unique_ptr<TableFile> open_table(const std::string& path, const TextForm& form,
                                      std::size_t most_values);

}  // namespace stillhand::measurement

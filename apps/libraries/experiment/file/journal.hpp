// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/libraries/experiment/core/progress.hpp"

namespace stillhand::experiment {

/// One entry as a line of JSON, without its end.
std::string line_of(const Entry& entry);

/// Entries of a journal's text.  Bytes behind the last end of line are a line that a crash cut: it
/// never happened.
/// @param origin  name for messages
/// @throws ConfigError "file:line: ..." for a whole line that is no entry
std::vector<Entry> entries_of(const std::string& text, const std::string& origin);

/// The entries of a journal's file, without a lock; none if there is no file.
std::vector<Entry> read_journal(const std::filesystem::path& file);

/// The append-only journal of one participant, or of the folder, one JSON line for each entry.
/// append() returns when the disk has the line, so a kill at any instant leaves whole lines and at
/// most one cut one.  The next open removes the cut line.  It holds a lock (flock) on the file as
/// long as it lives.
class Journal {
 public:
  /// Opens or makes the file.
  /// @throws ConfigError when another process has it, it cannot be written, or a line is no entry
  explicit Journal(const std::filesystem::path& file);
  ~Journal();
  Journal(const Journal&) = delete;
  Journal& operator=(const Journal&) = delete;

  /// What is in it so far, those of append() included.
  [[nodiscard]] const std::vector<Entry>& entries() const noexcept { return entries_; }
  /// Adds the time and writes the entry.
  /// @throws std::runtime_error when the disk refuses; the file then holds whole lines, as before
  const Entry& append(Entry entry);

 private:
  /// Removes what a write that failed left behind the whole lines.
  void cut();

  std::filesystem::path file_;
  int descriptor_ = -1;
  std::uint64_t whole_ = 0;  ///< [bytes] of whole lines
  std::vector<Entry> entries_;
};

/// UTC now, "2026-11-25T05:50:00Z".
std::string utc_now();

}  // namespace stillhand::experiment

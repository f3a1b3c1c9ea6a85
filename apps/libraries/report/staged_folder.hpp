// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::report {

/// A folder of results that appears as a whole.  Files are made in a hidden folder inside it, then
/// moved into place together.  A failure, an exception or Ctrl-C before that leaves the folder
/// unchanged, or removes it if it is new.  The folder is locked, so one program uses it at a time.
class StagedFolder {
 public:
  /// Makes both folders, so that an error shows before the work.
  /// @param option  the option that names the folder, for messages
  /// @throws ConfigError naming the option when the folder cannot be made or written, or is locked.
  explicit StagedFolder(const std::filesystem::path& out, std::string option = "--out");
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// The hidden folder, in which files are made.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return staging_; }
  /// Writes a file in path().  @throws std::runtime_error with the file and the reason
  void write(const std::string& name, const std::string& text) const;
  /// Names of the files that are in the folder already, begin and end so, and hold the mark: of an
  /// earlier run.
  [[nodiscard]] std::vector<std::string> in_place(const std::string& begin, const std::string& end,
                                                  const std::string& mark) const;
  /// Checks that every file in path() can be moved; publish() calls it too.
  /// @throws ConfigError naming a folder that is in the way
  void check() const;
  /// Moves every file into place, over files of the same name.
  /// @param own  every name that this program may write here; files of these names that this run
  ///             did not write are from an earlier run and are removed
  /// @throws ConfigError as check(); then nothing was moved
  void publish(const std::vector<std::string>& own);
  /// Removes what is not in place, as the destructor does.
  void clear_away() noexcept;

 private:
  void make();
  void lock();

  std::string option_;
  std::filesystem::path out_;  ///< absolute
  std::filesystem::path staging_;
  std::filesystem::path made_;  ///< outermost folder that this object made; empty: none
  int descriptor_ = -1;         ///< open folder, which holds the lock
};

}  // namespace stillhand::report

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::report {

/// A folder of results that appears as a whole: files are made in a hidden folder inside it, then
/// moved into place together.  A failure, an exception or Ctrl-C before that leaves the folder as
/// it was, or no folder where there was none.  One program at a time: the folder is locked.
class StagedFolder {
 public:
  /// Makes both, so that what cannot be written is known before the work.
  /// @param option  that named the folder, for messages
  /// @throws ConfigError naming the option when the folder cannot be made or written, or is locked.
  explicit StagedFolder(const std::filesystem::path& out, std::string option = "--out");
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Where files are to be made.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return staging_; }
  /// A whole file in path().  @throws std::runtime_error which, and why
  void write(const std::string& name, const std::string& text) const;
  /// @throws ConfigError naming what is in the way of a file in path(); publish() asks first, too.
  void check() const;
  /// Moves everything into place, over files of the same name.
  /// @param own  every name that this program may write here: those that were not written now are
  ///             of an earlier run and go
  /// @throws ConfigError naming what is in the way; nothing was moved then.
  void publish(const std::vector<std::string>& own);

 private:
  void make();
  void lock();
  void clear_away() noexcept;

  std::string option_;
  std::filesystem::path out_;  ///< absolute
  std::filesystem::path staging_;
  std::filesystem::path made_;  ///< outermost folder that was made here; empty: none
  int descriptor_ = -1;         ///< of the folder; carries the lock
};

}  // namespace stillhand::report

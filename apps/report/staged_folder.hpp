// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace stillhand::report {

/// A folder of results that appears as a whole: files are made in a hidden folder inside it, then
/// moved into place together.  A failure, an exception or Ctrl-C before that leaves the folder as
/// it was, or no folder where there was none.
class StagedFolder {
 public:
  /// Makes both, so that what cannot be written is known before the work.
  /// @throws ConfigError "--out" when the folder cannot be made or written.
  explicit StagedFolder(const std::filesystem::path& out);
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  /// Where files are to be made.
  [[nodiscard]] const std::filesystem::path& path() const noexcept { return staging_; }
  /// A whole file in path().  @throws std::runtime_error which, and why
  void write(const std::string& name, const std::string& text) const;
  /// Moves everything into place, over what has the same name.
  /// @throws std::runtime_error which file, and why
  void publish();

 private:
  std::filesystem::path out_;
  std::filesystem::path staging_;
  std::filesystem::path made_;  ///< outermost folder that was made here; empty: none
};

}  // namespace stillhand::report

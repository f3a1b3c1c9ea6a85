// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::recordings {

/// A file on its way: made under a name of its own beside its place, and moved there when it is
/// complete.  Gone, when that never happens.
class PendingFile {
 public:
  /// @throws ConfigError when the place holds something that is not a regular file
  explicit PendingFile(std::string place);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Where it is to be written.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Writes to the disk, then replaces the file at its place.  @throws std::runtime_error
  void publish();
  /// Same, where nothing may be there yet.
  /// @throws ConfigError naming the place when it is taken; std::runtime_error
  void publish_new();

 private:
  void to_disk() const;

  std::string place_;
  std::string path_;
};

}  // namespace stillhand::recordings

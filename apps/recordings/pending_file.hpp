// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace stillhand::recordings {

/// A file on its way: made under a name of its own beside its place, and moved there when it is
/// complete.  Gone, when that never happens.
class PendingFile {
 public:
  /// @throws ConfigError when something that is no file is there
  explicit PendingFile(std::string place);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Where it is to be written.
  [[nodiscard]] const std::string& path() const noexcept { return path_; }
  /// Onto the disk, then to its place, over what is there.  @throws std::runtime_error
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

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

namespace stillhand::lab {

/// Of the diagnosis between two trials, in a session's folder.
inline constexpr const char* kClosingFolder = "closing";

/// The folder of a session's results: it is made if need be, proved writable, locked against other
/// labs, and cleared of the files of an earlier session.  These wait in a hidden folder inside: a
/// session that never began gives them back; after any other they stay, in `earlier-1`,
/// `earlier-2` and so on.
class OutputFolder {
 public:
  /// @param inputs  files that the session reads; empty ones don't count
  /// @throws ConfigError when the folder cannot be made or written, an input would be cleared away,
  ///         or another lab uses it.
  OutputFolder(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Removes the files of the session and brings those of the earlier one back; removes the folder
  /// if it was made here.
  void discard();

 private:
  void make();
  void prove_writable() const;
  void lock();
  void refuse_if_needed(const std::filesystem::path& input) const;
  void clear() const;
  void set_aside() const;
  void bring_back() const;
  void keep_earlier() const;

  std::filesystem::path path_;
  std::filesystem::path earlier_;  ///< where an earlier session's files wait
  bool made_ = false;
  int descriptor_ = -1;  ///< of the folder; carries the lock
};

}  // namespace stillhand::lab

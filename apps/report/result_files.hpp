// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::report {

/// One file that a command was asked for.
struct ResultFile {
  std::string option;          ///< that named it, for messages: "--save"
  std::filesystem::path path;  ///< empty: not asked for
};

/// Files of results that appear together, over files of the same names, or not at all.  What isn't
/// a plain file, such as /dev/stdout, is written as it stands.
class ResultFiles {
 public:
  /// Looks at the places, so that what can't be written is known before the work; makes nothing.
  /// @param inputs  files that are read: none may be written over
  /// @throws ConfigError naming the option, when two files are one, an input would be lost, or a
  ///         file can't be made there.
  ResultFiles(const std::vector<ResultFile>& files,
              const std::vector<std::filesystem::path>& inputs);

  [[nodiscard]] bool wants(const std::string& option) const;
  /// What is to be in a file that was asked for.
  void set(const std::string& option, std::string text);
  /// Writes everything beside its place, then moves it there.
  /// @throws std::runtime_error which, and why; files that were there before are then as they were.
  void publish();

 private:
  struct Entry {
    ResultFile file;
    std::filesystem::path place;  ///< of the file itself, links followed
    bool plain = true;
    std::string text;
  };

  std::vector<Entry> entries_;
};

}  // namespace stillhand::report

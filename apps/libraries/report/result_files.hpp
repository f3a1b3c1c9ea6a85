// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace stillhand::report {

/// One file that an option names.
struct ResultFile {
  std::string option;          ///< the option, for messages: "--save"
  std::filesystem::path path;  ///< empty: the option was not given
};

/// Files of results that appear together or not at all.  They replace files of the same names.  A
/// path that is no plain file, such as /dev/stdout, is written directly.  "-" is standard output;
/// what the verb prints otherwise then goes to standard error, so that a pipe gets the result
/// alone.
class ResultFiles {
 public:
  /// Checks the places before the work, without writing.
  /// @param inputs  files that are read: none may be overwritten
  /// @throws ConfigError naming the option, when two paths are the same file, an input would be
  ///         overwritten, or a file can't be made.
  ResultFiles(const std::vector<ResultFile>& files,
              const std::vector<std::filesystem::path>& inputs);

  [[nodiscard]] bool wants(const std::string& option) const;
  /// Sets the content of a wanted file.
  void set(const std::string& option, std::string text);
  /// Sets it to a JSON object with its provenance, where it is wanted.
  /// @throws std::runtime_error for an input that cannot be read
  void set_json(const std::string& option, const std::string& json);
  /// Writes every file next to its place, then moves it there.
  /// @throws std::runtime_error with the file and the reason; earlier files are then unchanged.
  void publish();

 private:
  struct Entry {
    ResultFile file;
    std::filesystem::path place;  ///< path of the file itself, with links followed
    bool plain = true;
    int descriptor = -1;  ///< to which "-" is written
    std::string text;
  };

  std::vector<Entry> entries_;
  std::vector<std::filesystem::path> inputs_;
};

}  // namespace stillhand::report

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "apps/libraries/report/staged_folder.hpp"

namespace stillhand::experiment {

/// Name of the file with the checksums of all others, in the format of sha256sum.
inline constexpr const char* kSumsFile = "SHA256SUMS";

/// The files of a data set in a staged folder, with their checksums.
class SetFiles {
 public:
  explicit SetFiles(report::StagedFolder& out) : out_(out) {}

  /// Writes a file; its name may begin with folders.
  /// @throws std::runtime_error when the disk refuses
  void write(const std::string& name, const std::string& text);
  /// Takes a file that is there already.
  void add(const std::string& name);
  /// After all others.
  void write_sums();

 private:
  report::StagedFolder& out_;
  std::vector<std::pair<std::string, std::string>> lines_;  ///< name, line of sha256sum
};

}  // namespace stillhand::experiment

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "recording/core/mcap_reader.hpp"
#include "recording/file_io.hpp"

namespace stillhand::recorder {

/// A recording that is open for reading: whole, cut off or damaged.
struct OpenRecording {
  /// @throws ConfigError when the file can't be read or is no MCAP file of version 0.
  explicit OpenRecording(const std::string& file);

  /// Says on standard error, in one line, what is lost; nothing where nothing is.
  /// @param messages  [-] that were delivered
  void tell_loss(std::uint64_t messages) const;

  std::string path;
  recording::FileSource source;
  recording::McapReader reader;
};

/// Outcome of a walk.  @throws std::runtime_error with the path when the source failed.
void check(const recording::Status& status);

}  // namespace stillhand::recorder

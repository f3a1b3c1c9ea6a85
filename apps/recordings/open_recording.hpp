// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::recordings {

/// Whether the end was requested, as by Ctrl-C; empty: never.  Called repeatedly.
using Stopped = std::function<bool()>;

/// The end was requested before the results were in place.
struct Interrupted : std::runtime_error {
  Interrupted() : std::runtime_error("stopped before the end; nothing was written") {}
};

/// @throws Interrupted when `stopped` says so
void go_on_unless(const Stopped& stopped);

/// A recording whose reading can be given up: every way through it ends here.
class StoppableFile : public recording::FileSource {
 public:
  StoppableFile(const std::string& path, Stopped stopped);
  /// @throws Interrupted
  recording::Status read_at(std::uint64_t offset, std::span<std::byte> into) override;

 private:
  Stopped stopped_;
};

/// A recording that is open for reading: whole, cut off or damaged.
struct OpenRecording {
  /// @throws ConfigError when the file can't be read or is no MCAP file of version 0; Interrupted,
  ///         now or while it is read.
  explicit OpenRecording(const std::string& file, Stopped stopped = {});

  /// Prints on standard error, in a line each, what is lost and how its clock was set; nothing if
  /// nothing is.
  /// @param messages  [-] that were delivered
  void report_loss(std::uint64_t messages) const;

  std::string path;
  StoppableFile source;
  recording::McapReader reader;
};

/// Outcome of a walk.  @throws std::runtime_error with the path when the source failed.
void check(const recording::Status& status);

}  // namespace stillhand::recordings

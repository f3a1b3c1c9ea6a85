// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/recordings/open_recording.hpp"

namespace stillhand::recordings {

struct RecoverOptions {
  std::filesystem::path out;  ///< empty: the file itself; the old one is kept as FILE.damaged
  recording::Compression compression = recording::Compression::kZstd;
  Stopped stopped = {};  ///< true: give up
};

/// The result of recover().
struct Recovered {
  bool was_whole = false;  ///< nothing to mend: nothing was written
  std::string out;         ///< where the whole file is now
  std::string kept;        ///< where the old one is now; empty: where it was
  std::uint64_t messages = 0;
  std::uint64_t lost_bytes = 0;
  std::uint32_t attachments = 0;  ///< [-] of the old file, which are not carried over
  std::vector<std::string> findings;
};

/// Writes everything that can be read into a whole file: messages in the order of the file, with
/// their numbers and times, schemas, topics, metadata; and a metadata record "stillhand.recovery"
/// that says what was lost.  The new file appears when it is complete and on the disk, nothing is
/// left of it when that never happens, and no file is written over.
/// @throws ConfigError when the file can't be read, is still being written, or a name is taken;
///         std::runtime_error when there is nothing to recover or the disk fails, Interrupted: the
///         old file is then as it was.
Recovered recover(const std::string& path, const RecoverOptions& options);

}  // namespace stillhand::recordings

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "services/recording/core/mcap/compression.hpp"
#include "services/recording/file_io.hpp"
#include "services/recording/tape.hpp"

namespace CLI {
class App;
}

namespace stillhand::recording {

/// How a recorder keeps what it gets; the same options wherever one is started.
struct KeepOptions {
  Compression compression = Compression::kZstd;
  std::chrono::milliseconds flush_interval{500};  ///< between chunks: a kill costs at most this
                                                  ///< and what waits for the disk
  Durability durability = Durability::kProcess;
  double min_free_mb = 16;  ///< [MB] left on the disk; below, the recording stops
};

/// Adds --compression, --flush-ms, --fsync and --min-free-mb, which set `options` as they are
/// parsed.
void add_keep_options(CLI::App& cli, KeepOptions& options);

/// The same as words of a command line, for a recorder that another process starts.
std::vector<std::string> keep_words(const KeepOptions& options);

/// A tape that keeps what it gets so.
TapeOptions tape_options(const KeepOptions& keep, const std::string& path);

}  // namespace stillhand::recording

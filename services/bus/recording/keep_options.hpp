// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>
#include <vector>

#include "services/bus/recording/tape.hpp"
#include "services/core/recording/mcap/compression.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::command_line {
class Command;
}

namespace stillhand::recording {

/// Options of a recorder; every program that starts a recorder has the same options.
struct KeepOptions {
  Compression compression = Compression::kZstd;
  std::chrono::milliseconds flush_interval{500};  ///< between chunks: a kill loses at most this
                                                  ///< time and the data that wait for the disk
  Durability durability = Durability::kProcess;
  double min_free_mb = 16;  ///< [MB] free on the disk; below it the recording stops

  bool operator==(const KeepOptions&) const = default;
};

/// Adds --compression, --flush-ms, --fsync and --min-free-mb; parsing sets `options`.
void add_keep_options(command_line::Command& cli, KeepOptions& options);

/// The options as words of a command line, to start a recorder in another process.
std::vector<std::string> keep_words(const KeepOptions& options);

/// Options of a tape with these settings.
TapeOptions tape_options(const KeepOptions& keep, const std::string& path);

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <string>

#include "recording/core/compression.hpp"
#include "recording/core/mcap_writer.hpp"
#include "recording/file_io.hpp"

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
};

/// Adds --compression, --flush-ms and --fsync, which set `options` as they are parsed.
void add_keep_options(CLI::App& cli, KeepOptions& options);

}  // namespace stillhand::recording

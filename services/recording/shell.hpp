// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "recording/core/mcap_writer.hpp"
#include "recording/file_io.hpp"
#include "recording/keep_options.hpp"
#include "runtime/service.hpp"

namespace stillhand::recording {

/// The recorder's process: every topic of the catalogue, as it came, into one MCAP file.  The
/// receiving thread only copies bytes into a queue; a thread of ordinary priority writes the file.
class Shell {
 public:
  Shell(runtime::Service& service, const KeepOptions& keep);
  void run();

 private:
  struct Held {
    ChannelId channel;
    std::uint64_t log_time_ns;
    std::uint64_t publish_time_ns;
    std::size_t begin;  // in bytes
    std::size_t size;
  };
  struct Batch {
    std::vector<Held> messages;
    std::vector<std::byte> bytes;
  };

  void subscribe(const topics::Topic& topic);
  void write_batches(const std::stop_token& stop);
  void write_batch(const Batch& batch);
  void write_counts();

  runtime::Service& service_;
  std::chrono::milliseconds flush_interval_;
  FileSink file_;
  McapWriter writer_;
  std::map<std::string, SchemaId> schemas_;
  std::map<ChannelId, std::uint32_t> sequences_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  Batch filling_;
  bool told_failure_ = false;
};

}  // namespace stillhand::recording

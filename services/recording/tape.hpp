// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "services/recording/core/event_window.hpp"
#include "services/recording/core/held_message.hpp"
#include "services/recording/core/mcap/mcap_writer.hpp"
#include "services/recording/core/rotation.hpp"
#include "services/recording/file_io.hpp"

namespace stillhand::recording {

/// How a recording is kept.
struct TapeOptions {
  std::string path;                              ///< of the first file
  McapWriterOptions writer;                      ///< chunks and compression
  std::int64_t flush_interval_ns = 500'000'000;  ///< [ns] between chunks; lost by a kill at most
  Durability durability = Durability::kProcess;  ///< what a chunk waits for
  RotationLimits rotation;
  std::uint64_t min_free_bytes = 16u << 20;   ///< [B] left on the disk; below, the tape stops
  std::int64_t window_ns = 0;                 ///< [ns] keep only this much until trigger(), 0: all
  std::size_t max_queued_bytes = 256u << 20;  ///< [B] waiting for the disk; what more comes is lost
  TextMap session;                            ///< metadata "stillhand.session" of every file
  std::function<std::vector<Metadata>()> last_words;  ///< metadata added to a file as it is closed
};

/// Where a tape is.
struct TapeStatus {
  std::uint64_t written = 0;      ///< messages in files
  std::uint64_t dropped = 0;      ///< messages lost between receiving and file
  std::uint64_t passed_over = 0;  ///< messages that came during a pause or left the window unwanted
  std::uint64_t held = 0;         ///< messages in the event window
  std::uint64_t bytes = 0;        ///< [B] of the file now open
  std::uint64_t free_bytes = 0;   ///< [B] left on the disk
  std::uint32_t parts = 0;        ///< files so far
  bool paused = false;
  std::string file;     ///< now open
  std::string stopped;  ///< why the tape has stopped by itself, or ""
};

/// Writes messages to MCAP files in a thread of its own: the receiving thread only copies bytes.
/// Rotation, event window, pause and disk guard are decided in that thread.  Every message that
/// does not get into a file is counted in the status.
///
/// When the disk has less than min_free_bytes left, or a write fails, the file is closed as well as
/// the disk allows and `stopped` says why; what comes later is dropped and counted.
class Tape {
 public:
  /// @throws ConfigError when the file cannot be made or the disk is too full to begin;
  ///         std::runtime_error when it cannot be written.  Either leaves no file behind.
  explicit Tape(TapeOptions options);
  ~Tape();
  Tape(const Tape&) = delete;
  Tape& operator=(const Tape&) = delete;

  /// A topic of one writer; any thread.  @returns its number
  std::uint32_t add_channel(Channel channel, std::string schema_name, std::string_view schema_text);
  /// Copies one message into the queue; any thread, does not wait for the disk.
  void put(std::uint32_t channel, std::uint32_t sequence, std::int64_t log_time_ns,
           std::int64_t publish_time_ns, std::span<const std::byte> bytes);

  /// What comes while paused is passed over, and counted.
  void set_paused(bool paused) noexcept { paused_.store(paused, std::memory_order_relaxed); }
  /// Writes what the event window holds, with a metadata record "stillhand.trigger" that says why.
  void trigger(const std::string& why);
  [[nodiscard]] TapeStatus status() const;
  /// Messages in files, by channel.
  [[nodiscard]] std::vector<std::uint64_t> written_by_channel() const;
  [[nodiscard]] bool stopped() const noexcept { return stopped_.load(std::memory_order_relaxed); }

  /// Writes what still waits and closes the file.  @returns the first failure of all
  Status close();

 private:
  struct Part;
  struct Definition {
    Channel channel;
    std::string schema_name;
    std::string_view schema_text;
  };

  void work(const std::stop_token& stop);
  void take_batch(MessageBatch& batch);
  void write_batch(const MessageBatch& batch);
  void write_window(const std::string& why);
  ChannelId id_of(std::uint32_t channel);
  bool open_part();
  void close_part();
  void guard_disk();
  void stop_because(std::string why);

  TapeOptions options_;
  std::unique_ptr<Part> part_;  // of the writing thread, as is window_
  EventWindow window_;
  std::int64_t flushed_ns_ = 0;
  std::int64_t guarded_ns_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  MessageBatch filling_;
  std::vector<Definition> definitions_;
  std::vector<std::uint64_t> written_;
  std::vector<std::string> triggers_;
  TapeStatus status_;
  std::atomic<bool> paused_{false};
  std::atomic<bool> stopped_{false};
  bool closed_ = false;
  std::jthread writing_;
};

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "services/core/recording/event_window.hpp"
#include "services/core/recording/held_message.hpp"
#include "services/core/recording/mcap/mcap_writer.hpp"
#include "services/core/recording/rotation.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::recording {

/// Options of a tape.
struct TapeOptions {
  std::string path;                              ///< path of the first file
  McapWriterOptions writer;                      ///< chunks and compression
  std::int64_t flush_interval_ns = 500'000'000;  ///< [ns] between chunks; largest loss by a kill
  Durability durability = Durability::kProcess;  ///< condition for the end of a write
  RotationLimits rotation;
  std::uint64_t min_free_bytes = 16u << 20;  ///< [B] free on the disk; below it the tape stops
  std::int64_t window_ns = 0;  ///< [ns] length of the event window until trigger(), 0: write all
  std::size_t max_queued_bytes = 256u
                                 << 20;  ///< [B] waiting for the disk; further messages are lost
  TextMap session;                       ///< metadata "stillhand.session" of every file
  std::vector<Metadata> first_words;     ///< further metadata at the beginning of every file
  std::function<std::vector<Metadata>()> last_words;  ///< metadata added when a file is closed
};

/// State of a tape.
struct TapeStatus {
  std::uint64_t written = 0;      ///< messages in files
  std::uint64_t dropped = 0;      ///< messages lost between receiving and file
  std::uint64_t passed_over = 0;  ///< messages received in a pause, or removed from the window
  std::uint64_t held = 0;         ///< messages in the event window
  std::uint64_t bytes = 0;        ///< [B] size of the open file
  std::uint64_t free_bytes = 0;   ///< [B] free on the disk
  std::uint32_t parts = 0;        ///< files so far
  bool paused = false;
  std::string file;     ///< the open file
  std::string stopped;  ///< reason why the tape stopped by itself, or ""
};

/// Writes messages to MCAP files in its own thread; the receiving thread only copies bytes.  The
/// writing thread decides on rotation, event window, pause and disk guard.  The status counts every
/// message that is not in a file.
///
/// If the disk has less than min_free_bytes free, or if a write fails, the tape closes the file as
/// far as the disk allows, and `stopped` states the reason.  It drops and counts later messages.
class Tape {
 public:
  /// @throws ConfigError if the file cannot be created or the disk is too full;
  ///         std::runtime_error if the file cannot be written.  Neither leaves a file.
  explicit Tape(TapeOptions options);
  ~Tape();
  Tape(const Tape&) = delete;
  Tape& operator=(const Tape&) = delete;

  /// Adds a topic of one writer; any thread.  @param schema_text  IDL, or "" if the type is not
  /// known by more than its name  @returns its number
  std::uint32_t add_channel(Channel channel, std::string schema_name, std::string_view schema_text);
  /// Copies one message into the queue; any thread; does not wait for the disk.  One that a file
  /// cannot hold (McapWriter::kMaxMessageBytes) is dropped and counted.
  void put(std::uint32_t channel, std::uint32_t sequence, std::int64_t log_time_ns,
           std::int64_t publish_time_ns, std::int64_t received_ns,
           std::span<const std::byte> bytes);
  /// Waits until the disk has every message that was put before; not after close(), and not from
  /// two threads.  @returns false when the tape stopped instead
  bool sync();

  /// A paused tape ignores messages and counts them.
  void set_paused(bool paused) noexcept { paused_.store(paused, std::memory_order_relaxed); }
  /// Writes the content of the event window and a metadata record "stillhand.trigger" with the
  /// reason.
  void trigger(const std::string& why);
  [[nodiscard]] TapeStatus status() const;
  /// Messages in files, by channel.
  [[nodiscard]] std::vector<std::uint64_t> written_by_channel() const;
  [[nodiscard]] bool stopped() const noexcept { return stopped_.load(std::memory_order_relaxed); }

  /// Writes the queued messages and closes the file.  @returns the first failure
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
  /// Nothing: the file has as many channels as MCAP allows.
  std::optional<ChannelId> id_of(std::uint32_t channel);
  void put_on_disk();
  bool open_part();
  void close_part();
  void guard_disk();
  void stop_because(std::string why);

  TapeOptions options_;
  std::unique_ptr<Part> part_;  // used by the writing thread, like window_
  EventWindow window_;
  std::int64_t flushed_ns_ = 0;
  std::int64_t guarded_ns_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable_any wake_;
  MessageBatch filling_;
  std::set<std::string, std::less<>> schema_texts_;  // each once
  std::vector<Definition> definitions_;
  std::vector<std::uint64_t> written_;
  std::vector<std::string> triggers_;
  bool sync_wanted_ = false;
  std::condition_variable_any synced_;
  TapeStatus status_;
  std::atomic<bool> paused_{false};
  std::atomic<bool> stopped_{false};
  bool closed_ = false;
  std::jthread writing_;
};

}  // namespace stillhand::recording

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "services/core/recording/held_message.hpp"
#include "services/core/recording/mcap/mcap_reader.hpp"
#include "services/files/recording/file_io.hpp"

namespace stillhand::replay {

/// Messages of one stretch of a recording, in the order of their log times; those of the same time
/// in the order of the file.
struct Stretch {
  std::uint64_t generation = 0;  ///< of the seek it belongs to
  recording::MessageBatch batch;
  bool last = false;  ///< nothing follows before the end that was asked for
};

/// Reads a recording in stretches of a second, ahead of the player, in a thread of its own: files
/// of any length, and of any order of messages inside, without holding more than three stretches.
///
/// After a seek the newest message of every latched channel (transient local) from before the
/// instant comes first, at that instant: the state that a reader would have found there.
/// One thread uses it; the reading one is its own.
class MessageSource {
 public:
  /// @param wanted   channels to read, by their number in the file  @param latched  of these
  MessageSource(recording::FileSource& file, const std::vector<recording::ChannelId>& wanted,
                const std::vector<recording::ChannelId>& latched);
  ~MessageSource();
  MessageSource(const MessageSource&) = delete;
  MessageSource& operator=(const MessageSource&) = delete;

  /// Goes on at `from_ns`, up to and with `to_ns`; log times.
  void seek(std::uint64_t from_ns, std::uint64_t to_ns);
  /// The next stretch of the newest seek; nothing while it is still being read.
  std::optional<Stretch> next();
  /// The same, once it is there.
  Stretch wait_next();
  /// Damage met so far.
  [[nodiscard]] std::vector<recording::Damage> damage() const;

 private:
  struct Request {
    std::uint64_t generation = 0, from_ns = 0, to_ns = 0;
  };
  void work(const std::stop_token& stop);
  bool superseded(std::uint64_t generation) const;
  bool publish(Stretch stretch, const std::stop_token& stop);
  Stretch state_before(const Request& request);
  Stretch read(std::uint64_t from_ns, std::uint64_t to_ns);
  std::optional<std::uint64_t> first_after(std::uint64_t from_ns, std::uint64_t to_ns);

  recording::McapReader reader_;
  std::vector<bool> wanted_;
  std::vector<bool> latched_;
  bool any_latched_ = false;

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  Request request_;
  std::deque<Stretch> ready_;
  std::vector<recording::Damage> damage_;
  std::jthread reading_;
};

}  // namespace stillhand::replay

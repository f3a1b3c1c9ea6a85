// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "services/bus/writer_qos.hpp"

namespace stillhand::runtime {

/// Writes recorded samples to a domain, as bytes, with the QoS they were recorded with.  Its
/// participant and every writer carry the replay's mark (replay_mark.hpp): processes of a session
/// drop its samples, and no rig permits a motor force while it is on the domain.  One thread.
class Playback {
 public:
  /// @throws ConfigError for a bad domain or profile file; BusError when DDS refuses.
  Playback(const std::filesystem::path& profiles, std::uint32_t domain, const std::string& name);
  ~Playback();
  Playback(const Playback&) = delete;
  Playback& operator=(const Playback&) = delete;
  Playback(Playback&&) noexcept;

  /// idl/ defines this type.
  [[nodiscard]] static bool knows(const std::string& type);
  /// Its writers can offer the representation of the samples.
  [[nodiscard]] static bool offers(const WriterQos& qos);
  /// The QoS of a writer profile of the file; nothing when it is missing.
  [[nodiscard]] std::optional<WriterQos> profile(const std::string& name) const;
  /// @param type  of qos.keyed, unless idl/ defines it  @returns its number  @throws BusError
  std::size_t add_writer(const std::string& topic, const std::string& type, const WriterQos& qos);
  /// CDR with its encapsulation header.  @returns false when DDS did not take it.
  bool write(std::size_t writer, std::span<const std::byte> bytes);
  /// Topics that other participants write now, replays excepted, and the name of one of each.
  [[nodiscard]] std::map<std::string, std::string> other_writers() const;
  /// Readers matched with this writer now.
  [[nodiscard]] std::uint32_t matched(std::size_t writer) const;
  /// Waits until reliable readers have everything, or for `limit_ns`.
  bool wait_for_acknowledgments(std::int64_t limit_ns);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillhand::runtime

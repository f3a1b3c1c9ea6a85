// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "fast_dds/names.hpp"
#include "idl/topics.hpp"
#include "services/bus/source.hpp"

namespace stillhand::runtime {

/// Which participant writes for each process of this rig's session, as the experiment names them,
/// and who else writes in the name of one.  Called from DDS's threads and the owner's; admits(),
/// speaks_for(), named(), sound() and why_not() are wait-free, the rest locks.
class Sources {
 public:
  using Prefix = ertps::GuidPrefix_t;
  using Handle = ertps::InstanceHandle_t;
  /// First bytes of the GUID of each of topics::kServices, as security makes them; empty: no keys.
  using Identities = std::vector<std::array<std::uint8_t, 6>>;

  /// A writer that the session did not name.  Valid as long as the Sources.
  struct Second {
    const topics::Topic* topic;
    std::string name;  ///< of its participant
    const char* id;    ///< "participant " and its number
  };
  struct Options {
    std::uint32_t rig = 1;
    std::optional<ParticipantId> experiment;  ///< nobody else names sources; nothing: any may
    Identities identities;
    std::function<void(const Second&)> on_second;  ///< once for each; no lock is held
  };

  /// Not a place of topics::kServices: the topic has several writers, or none in a session.
  static constexpr std::size_t kAnybody = topics::kServices.size();
  /// Place of the only process that writes a topic in topics::kServices.
  static std::size_t writer_of(const topics::Topic& topic);

  explicit Sources(Options options);

  /// An experiment names its session's sources.  While two do, nobody's count: without keys no
  /// process can tell which one it belongs to, and who came first may be a stranger.
  /// @returns false if they are not accepted: not one source for each process, not the sender as
  ///          the experiment, a participant of another identity, or not the expected experiment
  bool take(const ParticipantId& from, const std::vector<Source>& sources);

  void note_participant(const Prefix& participant, const std::string& name);
  void forget_participant(const Prefix& participant);
  /// The participant is of a replay, which opens the interlock by itself.
  void note_replay(const Prefix& participant);
  void note_writer(const Handle& writer, const std::string& topic);
  void forget_writer(const Handle& writer);
  /// A sample of this rig came from a writer that admits() or speaks_for() refuses.
  void note_refused(const Handle& writer);

  /// The writer belongs to the participant that is named for a process.  Before the sources are
  /// named: it writes for the experiment.
  [[nodiscard]] bool admits(std::size_t service, const Handle& writer) const noexcept;
  /// No session has named its sources yet, so nobody can say whether a writer writes for the
  /// process.  Between two sessions what comes is nobody's.
  [[nodiscard]] bool awaits(std::size_t service) const noexcept;
  /// The participant is the one that is named for the process.  Before that: anybody, for a process
  /// that starts says so.
  [[nodiscard]] bool speaks_for(std::string_view service,
                                const ParticipantId& participant) const noexcept;
  [[nodiscard]] bool named() const noexcept { return named_.load(std::memory_order_acquire); }
  /// More than one experiment names sources.
  [[nodiscard]] bool contested() const noexcept {
    return contested_.load(std::memory_order_acquire);
  }
  /// The sources are named, and nobody else writes the topics that have one writer.
  [[nodiscard]] bool sound() const noexcept {
    return named() && !second_present_.load(std::memory_order_acquire);
  }
  /// Why sound() is or was false, in one line that lives as long as this object.
  [[nodiscard]] const char* why_not() const noexcept;

 private:
  /// A participant, readable without a lock.  A torn read is equal to no participant.
  struct Named {
    std::atomic<bool> known{false};
    std::atomic<std::uint64_t> front{0};
    std::atomic<std::uint32_t> back{0};
  };
  struct Writer {
    const topics::Topic* topic;
    bool refused = false;  ///< it wrote a sample of this rig in a process's name
    std::optional<Second> second;
  };
  [[nodiscard]] bool acceptable(const ParticipantId& from,
                                const std::vector<Source>& sources) const;
  void adopt();
  void set(std::size_t service, const ParticipantId& participant);
  [[nodiscard]] static bool is(const Named& named, const std::uint8_t* participant) noexcept;
  [[nodiscard]] bool is_second(const Handle& handle, const Writer& writer) const;
  [[nodiscard]] bool of_another_rig(const std::string& name, const topics::Topic& topic) const;
  Second second_of(const Handle& handle, const Writer& writer);
  /// @returns those that are new
  std::vector<Second> judge();
  void report(const std::vector<Second>& fresh) const;
  const char* kept(std::string line);

  Options options_;
  std::array<Named, topics::kServices.size()> sources_;
  std::atomic<bool> named_{false};
  std::atomic<bool> ever_named_{false};
  std::atomic<bool> contested_{false};
  std::atomic<bool> second_present_{false};
  std::atomic<const char*> newest_second_{nullptr};  // a line of lines_

  std::mutex mutex_;                                                      // guards what follows
  std::vector<std::pair<ParticipantId, std::vector<Source>>> announced_;  // a single one counts
  std::map<Prefix, std::string> names_;
  std::map<Handle, Writer> writers_;  // of topics of idl/
  std::set<Prefix> replays_;
  std::deque<std::string> lines_;  // their addresses stay
};

}  // namespace stillhand::runtime

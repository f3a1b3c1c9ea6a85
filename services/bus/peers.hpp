// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "fast_dds/discovery.hpp"
#include "services/bus/found_writers.hpp"
#include "services/bus/sources.hpp"

namespace stillhand::runtime {

/// The participants on the bus: their names by GUID, the services with a life sign, and replays.  A
/// participant of Stillhand is named "stillhand/<rig>/<service>".  A replay, and a process that
/// answers one, carries kReplayMark in the user data of its participant and of each of its writers.
/// DDS announces a writer's user data before it matches the writer, so a reader knows the mark
/// before the first sample.  Called from DDS's threads and the owner's; every call locks, none
/// is made in the control path except alive(), replay_seen() and replay_present().
class Peers final : public DiscoveryListener {
 public:
  /// @param answers_replay  this process accepts samples of a replay, and is marked itself
  /// @param writers  notified of every writer, or nullptr
  /// @param secured  names are not proof; only authenticated participants count
  /// @param sources  alive() and life signs depend on them; nullptr: not, as outside of a session
  Peers(std::string self, std::uint32_t rig, bool answers_replay = false,
        FoundWriters* writers = nullptr, bool secured = false, Sources* sources = nullptr);

  static std::string participant_name(std::uint32_t rig, const std::string& service);

  void on_participant(const AnnouncedParticipant& announced) override;
  void on_writer(const AnnouncedWriter& announced) override;
  void onParticipantAuthentication(edds::DomainParticipant* participant,
                                   ertps::ParticipantAuthenticationInfo&& info) override;

  /// Service of this rig that owns an endpoint, or "" for a stranger or another rig's.
  [[nodiscard]] std::string service_of(const ertps::InstanceHandle_t& endpoint) const;
  /// A status writer came alive or stopped being so.  @return true when that changed anything.
  bool set_alive(const ertps::InstanceHandle_t& writer, bool alive);
  /// A sample of a status writer came.  Shows that the writer lives if set_alive() never counted
  /// for it: Fast DDS 2.9.1 loses the first change of liveliness when it comes while a reader is
  /// made, and it may come before the participant's name.  Locks until all services are alive.
  /// @return true when that changed anything.
  bool note_sample(const ertps::InstanceHandle_t& writer);

  /// The participant of each service of this rig, if there is exactly one; `own` is this one's.
  [[nodiscard]] std::vector<Source> sources_found(const ParticipantId& own) const;
  /// Sources::take(), and life signs count again.
  bool take_sources(const ParticipantId& from, const std::vector<Source>& sources);

  /// Each service of the catalogue but this one has a live status writer, the session's sources are
  /// named and alone, and no replay is on the bus; for a process that answers a replay: one is.
  /// Wait-free.
  [[nodiscard]] bool alive() const noexcept {
    if (answers_replay_) return replay_present();
    return all_alive_.load(std::memory_order_acquire) && !replay_present() &&
           (sources_ == nullptr || sources_->sound());
  }
  /// Why alive() is false, in one line: a replay, a second writer, or the process without a life
  /// sign that was noticed last.  The text lives as long as this object and its Sources.
  /// Wait-free.
  [[nodiscard]] const char* why_not_alive() const noexcept;
  /// A marked participant is on the bus now.  Wait-free.
  [[nodiscard]] bool replay_present() const noexcept {
    return replay_present_.load(std::memory_order_acquire);
  }
  /// A marked writer was found since the start: refuses() may be true.  Wait-free.
  [[nodiscard]] bool replay_seen() const noexcept {
    return replay_seen_.load(std::memory_order_acquire);
  }
  /// The writer of a sample is marked, and this process does not answer replays.
  [[nodiscard]] bool refuses(const ertps::InstanceHandle_t& writer) const;
  [[nodiscard]] std::vector<std::string> lost() const;
  [[nodiscard]] std::vector<std::string> duplicates() const;

 private:
  // The next three need the lock.
  bool count_alive(const ertps::InstanceHandle_t& writer, bool alive);
  void refresh();
  [[nodiscard]] bool is_of(std::size_t service,
                           const ertps::InstanceHandle_t& writer) const noexcept;
  void refresh_replay();
  [[nodiscard]] bool counts(const ertps::GuidPrefix_t& participant) const;
  void mark(const ertps::GuidPrefix_t& participant);

  std::string self_;
  std::string prefix_;
  mutable std::mutex mutex_;
  std::map<ertps::GuidPrefix_t, std::string> services_;  // by participant
  std::map<ertps::InstanceHandle_t, std::string> alive_writers_;
  std::set<std::string> ever_alive_;
  // Status writers of services whose liveliness was heard of: from then on samples prove nothing,
  // since the last of them may arrive after the writer's death.
  std::set<ertps::InstanceHandle_t> heard_;
  bool answers_replay_;
  FoundWriters* writers_;
  bool secured_;
  Sources* sources_;
  std::set<ertps::GuidPrefix_t> authenticated_;
  std::set<ertps::GuidPrefix_t> marked_now_;
  // Never forgotten: a sample may outlive its writer in a reader's history.
  std::set<ertps::GuidPrefix_t> ever_marked_;
  std::vector<std::string> missing_lines_;  // one for each of topics::kServices
  std::atomic<bool> all_alive_{false};
  std::atomic<std::size_t> newest_missing_{0};  // place in missing_lines_
  std::atomic<bool> replay_present_{false};
  std::atomic<bool> replay_seen_{false};
};

}  // namespace stillhand::runtime

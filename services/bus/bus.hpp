// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/bus/source.hpp"
#include "services/core/contract/tick.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

/// Trouble on the bus that no setting mends: exit status 1.
class BusError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The DDS side of one message type; defined for every struct of idl/ in message_types.cpp.
struct TypeTag;
template <typename Message>
const TypeTag& type_tag();

struct FoundWriter;

/// When a sample came, and of whom.
struct Arrival {
  std::int64_t received_ns;  ///< [ns] CLOCK_MONOTONIC of this process
  std::int64_t source_ns;    ///< [ns] system clock of the writer's host, as DDS stamped it
  std::int64_t logged_ns;    ///< [ns] system clock of this host
  std::int64_t sequence;     ///< [-] RTPS sequence number of its writer
  /// With Options::serialized: the writer, valid during the call, and its number in the order of
  /// finding.  nullptr without, and for a writer that discovery did not announce.
  const FoundWriter* writer = nullptr;
  std::size_t writer_number = 0;
  ParticipantId participant{};  ///< the writer's
  bool foreign = false;         ///< the session names another writer of the topic
};

/// An incident at an endpoint, reported from DDS's own threads.  Plain, so that it can leave a
/// receiving thread without lock or allocation.
struct BusIncident {
  stillhand_msgs::EventKind kind;
  const topics::Topic* topic;  ///< never null
  char peer[32];               ///< service concerned, where known; zero-terminated
  double by_us;                ///< [us] how much too late; of EVENT_TICKS_LOST, how long the gap is
  /// QoS policy of EVENT_INCOMPATIBLE_QOS, participant of EVENT_SECOND_WRITER; never null, lives as
  /// the Bus.
  const char* policy;
};

/// Counters of one endpoint, for the status topic.
struct EndpointReport {
  const topics::Topic* topic;
  bool written;
  std::uint32_t matched;
  std::uint64_t samples, lost_ticks, cycle_misses, deadline_misses;
  double worst_interval_us, latency_p50_us, latency_p99_us, latency_max_us;
};

namespace detail {
class WriterEndpoint;
void write(WriterEndpoint& endpoint, void* message);

/// The part of a delivered sample that the supervision needs.
struct SampleClock {
  bool ours = false;  ///< false: another rig's
  Tick tick = -1;     ///< -1: the type has none
  std::int64_t stamp_ns = 0;
  bool foreign = false;  ///< this rig's, from a writer that the session did not name
};
using Deliver = std::function<SampleClock(const void*, const Arrival&)>;
}  // namespace detail

/// One topic to write.  Fills in rig number and stamp.  Valid as long as its Bus.
template <typename Message>
class Publisher {
 public:
  Publisher() = default;
  Publisher(detail::WriterEndpoint* endpoint, std::uint32_t rig) : endpoint_(endpoint), rig_(rig) {}

  /// Does not block on best-effort topics.  `message` keeps its own fields otherwise.
  void write(Message& message) {
    message.rig(rig_);
    message.stamp_ns(monotonic_ns());
    detail::write(*endpoint_, &message);
  }

 private:
  detail::WriterEndpoint* endpoint_ = nullptr;
  std::uint32_t rig_ = 0;
};

/// One process on the bus: a DDS participant, its endpoints, and the peers matched with them.
/// Every endpoint takes its QoS profile (topics::profile_of()) from the profile file; none is set
/// in code.  Callbacks of subscriptions run one at a time in the thread that receives user data;
/// incidents come from DDS's event and discovery threads.
class Bus {
 public:
  struct Options {
    std::string service;             ///< own name, one of topics::kServices
    std::uint32_t rig = 1;           ///< key of the rig this process belongs to
    std::uint32_t domain = 0;        ///< DDS domain, 0 to 232
    std::filesystem::path profiles;  ///< qos/profiles.xml
    /// Every topic is carried as bytes: the recorder reads what it also writes, and one participant
    /// can hold a type name once.  subscribe_serialized() needs it.
    bool serialized = false;
    /// This process accepts samples of a replay and carries the replay's mark itself, so that no
    /// rig accepts its answers.  Other processes drop every sample of a marked writer.
    bool answers_replay = false;
    /// A process's samples come only from the participant that the experiment names for it
    /// (take_sources()); peers_alive() needs the names, and that nobody else writes a topic that
    /// has one writer.
    bool one_source = false;
    /// The experiment that started this process: nobody else names sources or announces a trial.
    std::optional<ParticipantId> experiment;
    /// A folder written by deploy/security/make.sh: only processes with a certificate of its
    /// authority exchange samples, each on its own topics.  Empty: no security.
    std::filesystem::path security;
    std::function<void(const BusIncident&)> on_incident;
  };

  /// @throws ConfigError for a bad domain, profile file or security folder; BusError when DDS
  /// refuses.
  explicit Bus(Options options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  /// @throws ConfigError when the profile of the topic's pattern is missing.
  template <typename Message>
  Publisher<Message> publisher(const topics::Topic& topic) {
    return {add_writer(topic, type_tag<Message>()), options_.rig};
  }

  /// Calls `on_sample(const Message&, const Arrival&)` for every sample of this rig.
  template <typename Message>
  void subscribe(const topics::Topic& topic,
                 std::function<void(const Message&, const Arrival&)> on_sample) {
    add_reader(topic, type_tag<Message>(), std::make_shared<Message>(),
               [this, &topic, call = std::move(on_sample), rig = options_.rig](
                   const void* sample, const Arrival& arrival) -> detail::SampleClock {
                 const auto& message = *static_cast<const Message*>(sample);
                 if (message.rig() != rig) return {};
                 if (arrival.foreign || !is_of_its_process(topic, message, arrival)) {
                   return {.foreign = true};
                 }
                 call(message, arrival);
                 if constexpr (requires { message.tick(); }) {
                   return {true, message.tick(), message.stamp_ns()};
                 } else {
                   return {true, -1, message.stamp_ns()};
                 }
               });
  }

  /// For the recorder: every sample of any rig as CDR with its encapsulation header; the callback
  /// returns its tick, and Arrival names the writer.  Takes the profile "record_stream" on
  /// best-effort topics.  Only with Options::serialized.
  void subscribe_serialized(
      const topics::Topic& topic,
      std::function<detail::SampleClock(std::span<const std::byte>, const Arrival&)> on_sample);

  /// Endpoints start to receive; call once, after every publisher() and subscribe().  @throws
  /// BusError for a topic that this service may not write or read (Options::security).
  void start();
  /// No callback of a subscription runs after this returns.  Publishers stay usable.
  void stop_receiving();

  /// Names of the processes that are matched with this process's endpoints of a topic: of this rig,
  /// without Taps.
  [[nodiscard]] std::set<std::string> matched_peers(const topics::Topic& topic) const;
  /// Number of each participant that calls itself `service` among them.
  [[nodiscard]] std::vector<ParticipantId> matched_as(const topics::Topic& topic,
                                                      const std::string& service) const;
  /// Catalogue peers that are not matched yet, as "service (topic)", empty when complete.
  [[nodiscard]] std::vector<std::string> missing_peers() const;
  /// Services that are on the bus more than once under this rig number.
  [[nodiscard]] std::vector<std::string> duplicate_peers() const;
  /// This process's own number on the bus.
  [[nodiscard]] ParticipantId participant() const;
  /// Every process of this rig that is on the bus, this one included; one that is there twice is
  /// there twice.
  [[nodiscard]] std::vector<Source> sources_found() const;
  /// The participant `from`, an experiment, names the sources of its session.  States that were
  /// written before are delivered now.  @returns false when they are not accepted
  /// (Sources::take()).
  bool take_sources(const ParticipantId& from, const std::vector<Source>& sources);
  /// True when every other service of the catalogue has a live status writer and no replay is on
  /// the domain; with Options::one_source, the sources are named, and nobody else writes for them.
  /// With Options::answers_replay: while a replay is on the domain.
  [[nodiscard]] bool peers_alive() const noexcept;
  /// A participant that carries the replay's mark is on the domain.
  [[nodiscard]] bool replay_present() const noexcept;
  /// Why peers_alive() is false, in one line with the name of the process that is missing.  The
  /// text lives as long as the bus.
  [[nodiscard]] const char* why_not_alive() const noexcept;
  /// Names of services whose status writer was alive once and is not now.
  [[nodiscard]] std::vector<std::string> lost_peers() const;

  /// By how much a service's monotonic clock is ahead of the experiment's; latencies of its samples
  /// are corrected by it.  Any thread.
  void set_clock_offset(const std::string& service, std::int64_t offset_ns);

  /// Counts of misses start and stop here: outside of a running session an absent sample is not a
  /// fault.
  void supervise(bool on) noexcept;
  /// Reports each silent 1 kHz topic that has no DDS deadline here.  The reporter calls it.
  void note_silence();
  [[nodiscard]] std::vector<EndpointReport> report() const;
  [[nodiscard]] const Options& options() const noexcept { return options_; }

 private:
  /// A topic of several processes: each message says which one wrote it, and only that one may.
  template <typename Message>
  [[nodiscard]] bool is_of_its_process(const topics::Topic& topic, const Message& message,
                                       const Arrival& arrival) const {
    if (topic.writers.size() == 1) return true;
    if constexpr (requires { message.service(); }) {
      return speaks_for(message.service().c_str(), arrival.participant);
    } else if constexpr (requires { message.source(); }) {
      return speaks_for(message.source().c_str(), arrival.participant);
    }
    return true;
  }
  [[nodiscard]] bool speaks_for(std::string_view service, const ParticipantId& from) const noexcept;
  detail::WriterEndpoint* add_writer(const topics::Topic& topic, const TypeTag& type);
  void add_reader(const topics::Topic& topic, const TypeTag& type, std::shared_ptr<void> sample,
                  detail::Deliver deliver);

  Options options_;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace stillhand::runtime

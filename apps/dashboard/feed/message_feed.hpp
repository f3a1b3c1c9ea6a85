// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/dashboard/core/bus_health.hpp"
#include "apps/dashboard/core/edge_health.hpp"
#include "apps/dashboard/core/force_record.hpp"
#include "apps/dashboard/core/qos_mismatches.hpp"
#include "apps/dashboard/core/traces.hpp"
#include "apps/dashboard/feed/cost_so_far.hpp"
#include "idl/clock.h"
#include "idl/recording.h"
#include "idl/session.h"
#include "idl/topics.hpp"
#include "services/core/contract/trial.hpp"

namespace stillhand::dashboard {

/// A writer, as the bus or a recording names it.
struct Source {
  std::string topic, type;
  std::string participant;  ///< "stillhand/<rig>/<service>" for a process of a session
  bool replayed = false;
};

/// One message, however it came.
struct Message {
  std::uint32_t source;              ///< its writer, as add() numbered it
  std::uint32_t sequence;            ///< low 32 bits of DDS's
  std::int64_t source_ns;            ///< [ns] system clock of its writer
  std::int64_t arrived_ns;           ///< [ns] system clock of the listener
  std::span<const std::byte> bytes;  ///< CDR with encapsulation header
};

struct FeedOptions {
  Config config;
  std::uint32_t rig = 1;
  bool blinded = true;                ///< data that reveal a trial's condition are not shown
  std::string listener = "recorder";  ///< process on whose host the arrivals were stamped
  /// The session's settings, for what lateness costs; none: it is not computed.
  std::optional<session::AnswerConfigs> answers = {};
};

/// The newest reports of a process.
struct ServiceView {
  std::optional<stillhand_msgs::ServiceStatus> status;
  std::optional<stillhand_msgs::HostStatus> host;
  std::int64_t host_at_ns = 0;                                          ///< its arrival
  std::uint64_t deadline_misses = 0, cycle_misses = 0, lost_ticks = 0;  ///< of all it reads
  std::map<std::string, EdgeHealth> reads;                              ///< by topic
};

/// The newest status of a `stillhand record`.
struct RecorderView {
  std::int64_t at_ns;
  stillhand_msgs::RecorderStatus status;
};

/// An event and its arrival.
struct HeardEvent {
  std::int64_t at_ns;
  stillhand_msgs::Event event;
};

/// The result of one message.
struct Heard {
  const topics::Topic* topic = nullptr;  ///< nullptr: of no topic or rig that is shown
  Verdict verdict;
};

/// From messages to the dashboard's numbers.  A live bus and a recording both use it, so that they
/// cannot count differently.  Samples of a replay are counted only while no process of a session
/// sends, since processes of a session drop them too.  One thread; no clock: time comes with
/// messages and step().  A copy is independent.
class MessageFeed {
 public:
  /// @throws ConfigError as BusHealth does
  explicit MessageFeed(FeedOptions options);

  /// Topics that it understands and may know.
  [[nodiscard]] bool wants(const std::string& topic) const;
  /// A writer.  @returns its number: 0, 1, 2 ...
  std::uint32_t add(const Source& source);
  Heard take(const Message& message);
  /// Ten times a second.
  void step(std::int64_t now_ns);
  void acknowledge() noexcept { health_.acknowledge(); }

  [[nodiscard]] const BusHealth& health() const noexcept { return health_; }
  [[nodiscard]] const FeedOptions& options() const noexcept { return options_; }
  [[nodiscard]] const std::optional<stillhand_msgs::TrialControl>& control() const noexcept {
    return control_;
  }
  /// What the participant's screen shows; it does not hold the condition.
  [[nodiscard]] const std::optional<stillhand_msgs::Prompt>& prompt() const noexcept {
    return prompt_;
  }
  /// Empty while blinded.
  [[nodiscard]] const std::string& condition() const noexcept { return condition_; }
  [[nodiscard]] const std::array<ServiceView, topics::kServices.size()>& services() const noexcept {
    return services_;
  }
  [[nodiscard]] const std::map<std::string, stillhand_msgs::ClockOffset>& clocks() const noexcept {
    return clocks_;
  }
  /// By name.
  [[nodiscard]] const std::map<std::string, RecorderView>& recorders() const noexcept {
    return recorders_;
  }
  /// [ns] when the rig reported an emergency stop; 0: none.
  [[nodiscard]] std::int64_t emergency_ns() const noexcept { return emergency_ns_; }
  /// Newest first.
  [[nodiscard]] const std::deque<HeardEvent>& events() const noexcept { return events_; }
  [[nodiscard]] const Traces& traces() const noexcept { return traces_; }
  [[nodiscard]] const ForceRecord& forces() const noexcept { return forces_; }
  /// None while blinded: it reveals whether the motor cancels.
  [[nodiscard]] const std::optional<CostSoFar>& cost() const noexcept { return cost_; }
  [[nodiscard]] const QosMismatches& qos_mismatches() const noexcept { return qos_mismatches_; }
  [[nodiscard]] bool replayed() const noexcept { return replayed_; }
  /// Which parts of the rig are devices, in its own words; empty: none, or it has not said so yet.
  [[nodiscard]] const std::string& rig_parts() const noexcept { return rig_parts_; }
  [[nodiscard]] Tick newest_tick() const noexcept { return newest_tick_; }
  /// Messages that are none of their type.
  [[nodiscard]] std::uint64_t malformed() const noexcept { return malformed_; }

 private:
  struct Known {
    std::size_t topic;  // place in the list, or kNone
    const topics::Topic* row;
    std::string service;  // of this rig, or empty
    bool replayed;
  };

  template <typename Decoded, typename Use>
  void decode(const Message& message, Use use);
  [[nodiscard]] bool passed_over(const Known& known);
  void look_into(const Known& known, const Message& message);
  void take_stream(const Known& known, const Message& message);
  void take_control(const stillhand_msgs::TrialControl& control, std::int64_t at_ns);
  void take_status(const stillhand_msgs::ServiceStatus& status, std::int64_t at_ns);
  void take_host(const stillhand_msgs::HostStatus& host, std::int64_t at_ns);
  void take_recorder(const Message& message);
  void take_event(const stillhand_msgs::Event& event, std::int64_t at_ns);
  void hide_delay();
  [[nodiscard]] bool tracks() const noexcept {
    return control_ && control_->phase() == stillhand_msgs::PHASE_TRACKING;
  }
  [[nodiscard]] bool forces_hidden(std::int64_t at_ns) const noexcept;
  [[nodiscard]] std::int64_t system_ahead_ns(const std::string& service) const;
  [[nodiscard]] std::int64_t ahead_of_rig_ns(const std::string& service) const;

  FeedOptions options_;
  BusHealth health_;
  std::vector<Known> sources_;
  std::optional<stillhand_msgs::TrialControl> control_;
  std::int64_t tracked_ns_ = 0;  ///< when the newest tracking trial was over; 0: none was
  std::optional<stillhand_msgs::Prompt> prompt_;
  std::string condition_;
  std::array<ServiceView, topics::kServices.size()> services_;
  std::map<std::string, stillhand_msgs::ClockOffset> clocks_;
  std::map<std::string, RecorderView> recorders_;
  std::deque<HeardEvent> events_;
  std::int64_t emergency_ns_ = 0;
  Traces traces_;
  ForceRecord forces_;
  std::optional<CostSoFar> cost_;
  QosMismatches qos_mismatches_;
  std::optional<std::uint32_t> rig_writer_;
  std::string rig_parts_;
  bool replayed_ = false, session_heard_ = false;
  Tick newest_tick_ = -1;
  std::uint64_t malformed_ = 0;
};

}  // namespace stillhand::dashboard

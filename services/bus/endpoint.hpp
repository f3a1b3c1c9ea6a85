// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "fast_dds/names.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/found_writers.hpp"
#include "services/bus/peers.hpp"
#include "services/core/signal/cycle_monitor.hpp"
#include "services/system/process/latest_value.hpp"

namespace stillhand::runtime::detail {

/// What both ends of a topic have in common: the catalogue row and who is matched.
class Endpoint {
 public:
  Endpoint(const topics::Topic& row, Peers& peers, const Bus::Options& options,
           const std::atomic<bool>& supervising)
      : topic_(row), peers_(peers), options_(options), supervising_(supervising) {}
  virtual ~Endpoint() = default;
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  /// @returns false when DDS refuses, as for a topic that is not this service's on a secured bus.
  [[nodiscard]] virtual bool enable() = 0;
  /// Deletes a reader, once its running callback has returned; nothing for a writer.
  virtual void close_reader(edds::Subscriber& /*owner*/) {}
  /// Delivers what waited for the session's sources; nothing for a writer.
  virtual void take_waiting() {}
  /// By how much the writer's monotonic clock is ahead of this process's [ns].
  virtual void set_clock_ahead(std::int64_t /*ahead_ns*/) noexcept {}
  /// Notes a missed deadline if this is a 1 kHz reader without a DDS deadline
  /// (topics::Topic::supervisor) and no sample has come for as long; nothing for others.
  virtual void note_silence() {}
  virtual EndpointReport report() = 0;
  /// Services matched now.
  [[nodiscard]] std::set<std::string> matched_services() const;
  /// The participants of one service among them.
  [[nodiscard]] std::vector<ParticipantId> matched_as(const std::string& service) const;
  [[nodiscard]] const topics::Topic& topic() const noexcept { return topic_; }
  [[nodiscard]] virtual bool writes() const noexcept = 0;

 protected:
  void note_match(const ertps::InstanceHandle_t& peer, int change);
  void note_incompatible(std::uint32_t policy);
  void note_incident(stillhand_msgs::EventKind kind, const std::string& peer, double by_us,
                     const char* policy = "") const;
  /// The service that writes the topic, by the catalogue; empty: there are several.  Its name fits
  /// into the string itself, so nothing is allocated.
  [[nodiscard]] std::string sole_writer() const;
  [[nodiscard]] std::uint32_t matched_count() const;

  const topics::Topic& topic_;
  Peers& peers_;
  const Bus::Options& options_;
  const std::atomic<bool>& supervising_;

 private:
  mutable std::mutex mutex_;
  std::set<ertps::InstanceHandle_t> matched_;
};

class WriterEndpoint final : public Endpoint, public edds::DataWriterListener {
 public:
  using Endpoint::Endpoint;

  bool enable() override { return ok(writer->enable()); }
  EndpointReport report() override;
  [[nodiscard]] bool writes() const noexcept override { return true; }

  // Set once, before enable().
  edds::DataWriter* writer = nullptr;
  const TypeTag* serializer = nullptr;  // real type of a topic carried as bytes

 private:
  friend void write(WriterEndpoint& endpoint, void* message);
  void on_publication_matched(edds::DataWriter*,
                              const edds::PublicationMatchedStatus& status) override;
  // Fast DDS 2.9.1 crashes on a missed offered deadline when the writer has no listener of its own.
  void on_offered_deadline_missed(edds::DataWriter*,
                                  const edds::OfferedDeadlineMissedStatus& status) override;
  void on_offered_incompatible_qos(edds::DataWriter*,
                                   const edds::OfferedIncompatibleQosStatus& status) override;

  std::atomic<std::uint64_t> samples_{0};
  std::atomic<std::uint64_t> deadline_misses_{0};
};

class ReaderEndpoint final : public Endpoint, public edds::DataReaderListener {
 public:
  /// @param sample  storage that each sample is taken into  @param deliver  called with it
  /// @param writers  where `deliver` hears of the writer, or nullptr
  ReaderEndpoint(const topics::Topic& row, Peers& peers, const Bus::Options& options,
                 const std::atomic<bool>& supervising, std::shared_ptr<void> sample,
                 Deliver deliver, FoundWriters* writers);

  bool enable() override { return ok(reader->enable()); }
  void close_reader(edds::Subscriber& owner) override;
  void take_waiting() override;
  void note_silence() override;
  EndpointReport report() override;
  [[nodiscard]] bool writes() const noexcept override { return false; }
  void set_clock_ahead(std::int64_t ahead_ns) noexcept override {
    clock_ahead_ns_.store(ahead_ns, std::memory_order_relaxed);
  }

  // Set once, before enable().
  edds::DataReader* reader = nullptr;
  Sources* sources = nullptr;  // nullptr: every writer's samples are taken

 private:
  void on_data_available(edds::DataReader*) override;
  void take_all();
  void on_subscription_matched(edds::DataReader*,
                               const edds::SubscriptionMatchedStatus& status) override;
  void on_requested_deadline_missed(edds::DataReader*,
                                    const edds::RequestedDeadlineMissedStatus& status) override;
  void on_liveliness_changed(edds::DataReader*,
                             const edds::LivelinessChangedStatus& status) override;
  void on_requested_incompatible_qos(edds::DataReader*,
                                     const edds::RequestedIncompatibleQosStatus& status) override;
  void supervise(Tick tick, std::int64_t sent_ns, std::int64_t arrived_ns);
  void note_missed(std::int64_t count);
  [[nodiscard]] bool has_living_writer() const noexcept;

  /// The topic is written once, by one process: a sample may wait until that process is named.
  /// A recorder takes everything at once.
  [[nodiscard]] bool may_wait() const noexcept {
    return sources != nullptr && !options_.serialized &&
           topic_.pattern == topics::Pattern::kStateLatched;
  }

  const std::size_t source_;    // place of the topic's only writer, or Sources::kAnybody
  std::atomic<int> takers_{0};  // where samples may wait
  std::shared_ptr<void> sample_;
  Deliver deliver_;
  std::optional<SampleWriters> writer_of_;  // receiving thread only
  std::atomic<std::uint64_t> samples_{0};
  std::atomic<std::uint64_t> deadline_misses_{0};
  std::atomic<std::int64_t> last_arrival_ns_{0};
  std::atomic<int> alive_writers_{0};
  std::atomic<bool> heard_of_life_{false};
  std::atomic<std::int64_t> clock_ahead_ns_{0};
  // Receiving thread only; snapshots leave through the triple buffer.
  signal::CycleMonitor monitor_;
  LatestValue<EndpointReport> snapshot_;
  std::mutex report_mutex_;
};

}  // namespace stillhand::runtime::detail

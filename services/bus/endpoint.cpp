// SPDX-License-Identifier: Apache-2.0
#include "services/bus/endpoint.hpp"

#include <algorithm>
#include <fastdds/dds/core/policy/QosPolicies.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>

#include "services/bus/serialized_sample.hpp"
#include "services/bus/type_tag.hpp"
#include "services/core/contract/time_difference.hpp"

namespace stillhand::runtime::detail {
namespace {

const char* policy_name(std::uint32_t policy) {
  switch (policy) {
    case edds::DURABILITY_QOS_POLICY_ID:
      return "DURABILITY";
    case edds::DEADLINE_QOS_POLICY_ID:
      return "DEADLINE";
    case edds::LIVELINESS_QOS_POLICY_ID:
      return "LIVELINESS";
    case edds::RELIABILITY_QOS_POLICY_ID:
      return "RELIABILITY";
    case edds::OWNERSHIP_QOS_POLICY_ID:
      return "OWNERSHIP";
    case edds::LATENCYBUDGET_QOS_POLICY_ID:
      return "LATENCY_BUDGET";
    case edds::DESTINATIONORDER_QOS_POLICY_ID:
      return "DESTINATION_ORDER";
    case edds::PARTITION_QOS_POLICY_ID:
      return "PARTITION";
    default:
      return "another policy";
  }
}

}  // namespace

std::set<std::string> Endpoint::matched_services() const {
  const std::lock_guard lock(mutex_);
  std::set<std::string> services;
  for (const auto& handle : matched_) services.insert(peers_.service_of(handle));
  services.erase("");
  return services;
}

std::vector<ParticipantId> Endpoint::matched_as(const std::string& service) const {
  const std::lock_guard lock(mutex_);
  std::vector<ParticipantId> participants;
  for (const auto& handle : matched_) {
    if (peers_.service_of(handle) != service) continue;
    ParticipantId& participant = participants.emplace_back();
    for (std::size_t i = 0; i < participant.size(); ++i) participant[i] = handle.value[i];
  }
  return participants;
}

std::uint32_t Endpoint::matched_count() const {
  const std::lock_guard lock(mutex_);
  return static_cast<std::uint32_t>(matched_.size());
}

void Endpoint::note_match(const ertps::InstanceHandle_t& peer, int change) {
  const std::lock_guard lock(mutex_);
  if (change > 0) {
    matched_.insert(peer);
  } else {
    matched_.erase(peer);
  }
}

void Endpoint::note_incompatible(std::uint32_t policy) {
  note_incident(stillhand_msgs::EVENT_INCOMPATIBLE_QOS, "", 0.0, policy_name(policy));
}

std::string Endpoint::sole_writer() const {
  return topic_.writers.size() == 1 ? std::string(topic_.writers.front()) : "";
}

void Endpoint::note_incident(stillhand_msgs::EventKind kind, const std::string& peer, double by_us,
                             const char* policy) const {
  if (!options_.on_incident) return;
  BusIncident incident{kind, &topic_, {}, by_us, policy};
  peer.copy(incident.peer, sizeof(incident.peer) - 1);
  options_.on_incident(incident);
}

void write(WriterEndpoint& endpoint, void* message) {
  endpoint.samples_.fetch_add(1, std::memory_order_relaxed);
  if (endpoint.serializer == nullptr) {
    endpoint.writer->write(message);
    return;
  }
  SerializedSample bytes = to_bytes(endpoint.serializer->support, message);
  endpoint.writer->write(&bytes);
}

EndpointReport WriterEndpoint::report() {
  EndpointReport report{};
  report.topic = &topic_;
  report.written = true;
  report.matched = matched_count();
  report.samples = samples_.load(std::memory_order_relaxed);
  report.deadline_misses = deadline_misses_.load(std::memory_order_relaxed);
  return report;
}

void WriterEndpoint::on_publication_matched(edds::DataWriter* /*writer*/,
                                            const edds::PublicationMatchedStatus& status) {
  note_match(status.last_subscription_handle, status.current_count_change);
}

void WriterEndpoint::on_offered_deadline_missed(edds::DataWriter* /*writer*/,
                                                const edds::OfferedDeadlineMissedStatus& status) {
  if (!supervising_.load(std::memory_order_relaxed)) return;
  deadline_misses_.fetch_add(status.total_count_change, std::memory_order_relaxed);
}

void WriterEndpoint::on_offered_incompatible_qos(edds::DataWriter* /*writer*/,
                                                 const edds::OfferedIncompatibleQosStatus& status) {
  note_incompatible(status.last_policy_id);
}

ReaderEndpoint::ReaderEndpoint(const topics::Topic& row, Peers& peers, const Bus::Options& options,
                               const std::atomic<bool>& supervising, std::shared_ptr<void> sample,
                               Deliver deliver, FoundWriters* writers)
    : Endpoint(row, peers, options, supervising),
      source_(Sources::writer_of(row)),
      sample_(std::move(sample)),
      deliver_(std::move(deliver)) {
  if (writers != nullptr) writer_of_.emplace(*writers);
}

void ReaderEndpoint::close_reader(edds::Subscriber& owner) {
  if (reader == nullptr) return;
  owner.delete_datareader(reader);
  reader = nullptr;
}

void ReaderEndpoint::on_data_available(edds::DataReader* /*source*/) {
  may_wait() ? take_waiting() : take_all();
}

// Called by the thread that receives the topic, and by the one that receives the sources.  No lock:
// each may hold Fast DDS's own.  Who comes second leaves its samples to the first.
void ReaderEndpoint::take_waiting() {
  if (!may_wait() || takers_.fetch_add(1) > 0) return;
  int seen = 0;
  do {
    seen = takers_.load();
    if (!sources->awaits(source_)) take_all();  // else they stay in the reader's history
  } while (takers_.fetch_sub(seen) != seen);
}

void ReaderEndpoint::take_all() {
  edds::SampleInfo info;
  while (ok(reader->take_next_sample(sample_.get(), &info))) {
    if (!info.valid_data || peers_.refuses(info.publication_handle)) continue;
    Arrival arrival{monotonic_ns(), info.source_timestamp.to_ns(), system_ns(),
                    static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long())};
    if (writer_of_) {
      if (const SampleWriters::Entry* entry = writer_of_->of(info.publication_handle)) {
        arrival.writer = &entry->writer;
        arrival.writer_number = entry->number;
      }
    }
    std::copy_n(&info.publication_handle.value[0], arrival.participant.size(),
                arrival.participant.begin());
    arrival.foreign = sources != nullptr && !sources->admits(source_, info.publication_handle);
    const auto clock = deliver_(sample_.get(), arrival);
    if (clock.foreign) sources->note_refused(info.publication_handle);
    if (!clock.ours) continue;
    samples_.fetch_add(1, std::memory_order_relaxed);
    last_arrival_ns_.store(arrival.received_ns, std::memory_order_relaxed);
    if (&topic_ == &topics::kServiceStatus && peers_.note_sample(info.publication_handle)) {
      note_incident(stillhand_msgs::EVENT_LIVELINESS_RECOVERED,
                    peers_.service_of(info.publication_handle), 0.0);
    }
    if (topic_.pattern == topics::Pattern::kStream1khz && clock.tick >= 0) {
      supervise(clock.tick, clock.stamp_ns, arrival.received_ns);
    }
  }
}

void ReaderEndpoint::supervise(Tick tick, std::int64_t sent_ns, std::int64_t arrived_ns) {
  if (!supervising_.load(std::memory_order_relaxed)) return;
  const std::int64_t ahead_ns = clock_ahead_ns_.load(std::memory_order_relaxed);
  const auto verdict = monitor_.step(tick, difference_ns(sent_ns, ahead_ns), arrived_ns);
  if (verdict.lost > 0) {
    note_incident(stillhand_msgs::EVENT_TICKS_LOST, sole_writer(),
                  static_cast<double>(verdict.lost * monitor_.period_us()));
  }
  if (verdict.late_by_us > 0) {
    note_incident(stillhand_msgs::EVENT_CYCLE_MISSED, sole_writer(),
                  static_cast<double>(verdict.late_by_us));
  }
  // A tenth of a second between snapshots: percentiles cost 200 additions.
  if (monitor_.samples() % 100 == 0) {
    EndpointReport report{};
    report.lost_ticks = static_cast<std::uint64_t>(monitor_.lost());
    report.cycle_misses = static_cast<std::uint64_t>(monitor_.misses());
    report.worst_interval_us = static_cast<double>(monitor_.worst_interval_us());
    report.latency_p50_us = static_cast<double>(monitor_.latency_us(0.50));
    report.latency_p99_us = static_cast<double>(monitor_.latency_us(0.99));
    report.latency_max_us = static_cast<double>(monitor_.max_latency_us());
    snapshot_.store(report);
  }
}

void ReaderEndpoint::note_silence() {
  constexpr std::int64_t kDeadline_ns = 5'000'000;  // as control_loop's acts (qos/README.md)
  const bool looks = topic_.pattern == topics::Pattern::kStream1khz && !options_.serialized &&
                     topic_.supervisor != options_.service;
  const std::int64_t last_ns = last_arrival_ns_.load(std::memory_order_relaxed);
  if (!looks || last_ns == 0 || matched_count() == 0) return;
  if (monotonic_ns() - last_ns > kDeadline_ns) note_missed(1);
}

EndpointReport ReaderEndpoint::report() {
  const std::lock_guard lock(report_mutex_);
  EndpointReport report = snapshot_.load();
  report.topic = &topic_;
  report.written = false;
  report.matched = matched_count();
  report.samples = samples_.load(std::memory_order_relaxed);
  report.deadline_misses = deadline_misses_.load(std::memory_order_relaxed);
  return report;
}

void ReaderEndpoint::on_subscription_matched(edds::DataReader* /*reader*/,
                                             const edds::SubscriptionMatchedStatus& status) {
  note_match(status.last_publication_handle, status.current_count_change);
  if (status.current_count_change < 0 && &topic_ == &topics::kServiceStatus) {
    const std::string peer = peers_.service_of(status.last_publication_handle);
    if (peers_.set_alive(status.last_publication_handle, false)) {
      note_incident(stillhand_msgs::EVENT_LIVELINESS_LOST, peer, 0.0);
    }
  }
}

void ReaderEndpoint::on_requested_deadline_missed(
    edds::DataReader* /*reader*/, const edds::RequestedDeadlineMissedStatus& status) {
  // The timer goes on after its writer died; that is liveliness's business.
  if (has_living_writer()) note_missed(status.total_count_change);
}

void ReaderEndpoint::note_missed(std::int64_t count) {
  if (!supervising_.load(std::memory_order_relaxed)) return;
  deadline_misses_.fetch_add(static_cast<std::uint64_t>(count), std::memory_order_relaxed);
  const std::int64_t silent_ns = monotonic_ns() - last_arrival_ns_.load(std::memory_order_relaxed);
  note_incident(stillhand_msgs::EVENT_DEADLINE_MISSED, sole_writer(),
                static_cast<double>(silent_ns) * 1e-3);
}

// The timer is armed by a sample, so without any word of liveliness (Peers::note_sample) a writer
// has lived.
bool ReaderEndpoint::has_living_writer() const noexcept {
  return !heard_of_life_.load(std::memory_order_relaxed) ||
         alive_writers_.load(std::memory_order_relaxed) > 0;
}

void ReaderEndpoint::on_liveliness_changed(edds::DataReader* /*reader*/,
                                           const edds::LivelinessChangedStatus& status) {
  // Not the status's own count, which stays one too low after a lost first change.
  const int change = status.alive_count_change;
  int alive_before = alive_writers_.load(std::memory_order_relaxed);
  while (!alive_writers_.compare_exchange_weak(alive_before, std::max(0, alive_before + change),
                                               std::memory_order_relaxed)) {
  }
  heard_of_life_.store(true, std::memory_order_relaxed);
  const bool alive = status.alive_count_change > 0;
  const std::string peer = peers_.service_of(status.last_publication_handle);
  if (&topic_ == &topics::kServiceStatus) {
    if (!peers_.set_alive(status.last_publication_handle, alive)) return;
  }
  note_incident(
      alive ? stillhand_msgs::EVENT_LIVELINESS_RECOVERED : stillhand_msgs::EVENT_LIVELINESS_LOST,
      peer, 0.0);
}

void ReaderEndpoint::on_requested_incompatible_qos(
    edds::DataReader* /*reader*/, const edds::RequestedIncompatibleQosStatus& status) {
  note_incompatible(status.last_policy_id);
}

}  // namespace stillhand::runtime::detail

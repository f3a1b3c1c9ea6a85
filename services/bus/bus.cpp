// SPDX-License-Identifier: Apache-2.0
#include "services/bus/bus.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <set>

#include "fast_dds/types.hpp"
#include "services/bus/endpoint.hpp"
#include "services/bus/found_writers.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/replay_mark.hpp"
#include "services/bus/type_tag.hpp"
#include "services/core/contract/config_error.hpp"
#include "services/core/contract/time_difference.hpp"

namespace stillhand::runtime {

struct Bus::Impl {
  explicit Impl(const Bus::Options& options)
      : sources({options.rig, options.experiment, identities(options),
                 [this, &options](const Sources::Second& second) { report(options, second); }}),
        peers(options.service, options.rig, options.answers_replay,
              options.serialized ? &writers : nullptr, !options.security.empty(),
              one_source(options) ? &sources : nullptr) {}
  ~Impl() {
    if (participant == nullptr) return;
    participant->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }

  /// A replay has other sources than the session it was recorded from.
  static bool one_source(const Bus::Options& options) {
    return options.one_source && !options.answers_replay;
  }
  static Sources::Identities identities(const Bus::Options& options);
  void report(const Bus::Options& options, const Sources::Second& second) const;

  /// The carrier of a type on this participant: the type itself, or its bytes.
  static edds::TypeSupport carrier(const Bus::Options& options, const edds::TypeSupport& real) {
    return options.serialized ? edds::TypeSupport(new SerializedType(real)) : real;
  }
  void open_reader(const Bus::Options& options, const topics::Topic& topic,
                   const edds::TypeSupport& type, const std::string& profile,
                   std::shared_ptr<void> sample, detail::Deliver deliver);

  // Readers and writers hand callbacks into `endpoints` until the participant is gone, and the
  // participant into `peers`, which notify `writers`: order of members matters.
  FoundWriters writers;
  Sources sources;
  Peers peers;
  std::atomic<bool> supervising{false};
  std::vector<std::unique_ptr<detail::Endpoint>> endpoints;
  std::mutex clock_mutex;
  std::map<std::string, std::int64_t> clock_offsets_ns;  ///< by service, against the experiment's
  std::map<std::string, edds::Topic*> topics;
  edds::DomainParticipant* participant = nullptr;
  edds::Publisher* publisher = nullptr;
  edds::Subscriber* subscriber = nullptr;
};

Sources::Identities Bus::Impl::identities(const Bus::Options& options) {
  Sources::Identities all;
  if (options.security.empty() || !one_source(options)) return all;
  const Identity own = Identity::of(options.security, options.service);
  for (const std::string_view service : topics::kServices) {
    all.push_back(guid_start(own, std::string(service)));
  }
  return all;
}

// Each reader of the topic reports it.  Sources are named after start(), so `endpoints` is
// complete.
void Bus::Impl::report(const Bus::Options& options, const Sources::Second& second) const {
  const bool reads = std::ranges::any_of(endpoints, [&](const auto& endpoint) {
    return !endpoint->writes() && &endpoint->topic() == second.topic;
  });
  if (!reads || !options.on_incident) return;
  BusIncident incident{stillhand_msgs::EVENT_SECOND_WRITER, second.topic, {}, 0.0, second.id};
  second.name.copy(incident.peer, sizeof(incident.peer) - 1);
  options.on_incident(incident);
}

Bus::Bus(Options options) : options_(std::move(options)) {
  impl_ = std::make_unique<Impl>(options_);
  impl_->participant = create_participant(
      options_.profiles, options_.domain, Peers::participant_name(options_.rig, options_.service),
      options_.answers_replay, Identity::of(options_.security, options_.service), &impl_->peers);
  // Endpoints wait for start(): a callback must not run before its owner is complete.
  edds::PublisherQos publisher_qos;
  publisher_qos.entity_factory().autoenable_created_entities = false;
  impl_->publisher = impl_->participant->create_publisher(publisher_qos);
  edds::SubscriberQos subscriber_qos;
  subscriber_qos.entity_factory().autoenable_created_entities = false;
  impl_->subscriber = impl_->participant->create_subscriber(subscriber_qos);
  if (impl_->publisher == nullptr || impl_->subscriber == nullptr) {
    throw BusError("Fast DDS created no publisher or subscriber");
  }
  if (options_.serialized) {
    impl_->writers.learn_depths(*impl_->publisher, options_.profiles);
    // A participant does not discover itself.
    impl_->writers.note_participant(impl_->participant->guid().guidPrefix,
                                    Peers::participant_name(options_.rig, options_.service));
  }
}

Bus::~Bus() = default;

namespace {

edds::Topic* topic_of(edds::DomainParticipant& participant,
                      std::map<std::string, edds::Topic*>& known, const topics::Topic& row,
                      const edds::TypeSupport& type) {
  const std::string name(row.name);
  if (known.count(name) == 0) {
    type.register_type(&participant);
    known[name] = participant.create_topic(name, std::string(row.type), edds::TOPIC_QOS_DEFAULT);
  }
  if (known[name] == nullptr) throw BusError("Fast DDS refused the topic " + name);
  return known[name];
}

}  // namespace

detail::WriterEndpoint* Bus::add_writer(const topics::Topic& topic, const TypeTag& type) {
  const std::string profile(topics::profile_of(topic));
  edds::DataWriterQos qos;
  if (!ok(impl_->publisher->get_datawriter_qos_from_profile(profile, qos))) {
    throw missing_profile(options_.profiles, "data_writer", profile);
  }
  if (options_.answers_replay) qos.user_data().data_vec(replay_mark());
  edds::Topic* dds_topic =
      topic_of(*impl_->participant, impl_->topics, topic, impl_->carrier(options_, type.support));
  auto endpoint =
      std::make_unique<detail::WriterEndpoint>(topic, impl_->peers, options_, impl_->supervising);
  if (options_.serialized) endpoint->serializer = &type;
  endpoint->writer = impl_->publisher->create_datawriter(dds_topic, qos, endpoint.get());
  if (endpoint->writer == nullptr) {
    throw BusError("Fast DDS refused the writer of " + std::string(topic.name));
  }
  detail::WriterEndpoint* const added = endpoint.get();
  impl_->endpoints.push_back(std::move(endpoint));
  return added;
}

void Bus::add_reader(const topics::Topic& topic, const TypeTag& type, std::shared_ptr<void> sample,
                     detail::Deliver deliver) {
  if (options_.serialized) {
    // Bytes come in; the typed callback gets a message made from them.
    deliver = [real = type.support, message = std::move(sample), call = std::move(deliver)](
                  const void* bytes, const Arrival& arrival) -> detail::SampleClock {
      if (!from_bytes(real, *static_cast<const SerializedSample*>(bytes), message.get())) return {};
      return call(message.get(), arrival);
    };
    sample = std::make_shared<SerializedSample>();
  }
  impl_->open_reader(options_, topic, impl_->carrier(options_, type.support),
                     std::string(topics::profile_of(topic, options_.service)), std::move(sample),
                     std::move(deliver));
}

void Bus::subscribe_serialized(
    const topics::Topic& topic,
    std::function<detail::SampleClock(std::span<const std::byte>, const Arrival&)> on_sample) {
  const TypeTag* real = find_type(topic.type);
  if (real == nullptr || !options_.serialized) {
    throw BusError("Fast DDS cannot serialize " + std::string(topic.type));
  }
  const bool stream = topic.pattern == topics::Pattern::kStream1khz ||
                      topic.pattern == topics::Pattern::kStreamSlow ||
                      topic.pattern == topics::Pattern::kExchange;
  impl_->open_reader(options_, topic, impl_->carrier(options_, real->support),
                     std::string(stream ? "record_stream" : topics::profile_of(topic.pattern)),
                     std::make_shared<SerializedSample>(),
                     [call = std::move(on_sample)](const void* sample, const Arrival& arrival) {
                       // What others write is recorded, too.
                       return call(*static_cast<const SerializedSample*>(sample), arrival);
                     });
}

void Bus::Impl::open_reader(const Bus::Options& options, const topics::Topic& topic,
                            const edds::TypeSupport& type, const std::string& profile,
                            std::shared_ptr<void> sample, detail::Deliver deliver) {
  edds::DataReaderQos qos;
  if (!ok(subscriber->get_datareader_qos_from_profile(profile, qos))) {
    throw missing_profile(options.profiles, "data_reader", profile);
  }
  edds::Topic* dds_topic = topic_of(*participant, topics, topic, type);
  auto endpoint = std::make_unique<detail::ReaderEndpoint>(topic, peers, options, supervising,
                                                           std::move(sample), std::move(deliver),
                                                           options.serialized ? &writers : nullptr);
  // Sources::take() decides by itself which experiment names them.
  if (one_source(options) && &topic != &topics::kSessionSources) endpoint->sources = &sources;
  endpoint->reader = subscriber->create_datareader(dds_topic, qos, endpoint.get());
  if (endpoint->reader == nullptr) {
    throw BusError("Fast DDS refused the reader of " + std::string(topic.name));
  }
  endpoints.push_back(std::move(endpoint));
}

void Bus::start() {
  for (const auto& endpoint : impl_->endpoints) {
    if (endpoint->enable()) continue;
    const std::string name(endpoint->topic().name);
    throw BusError("Fast DDS does not let " + options_.service +
                   (endpoint->writes() ? " write " : " read ") + name +
                   (options_.security.empty() ? "" : ": do its permissions allow it?"));
  }
}

void Bus::stop_receiving() {
  // The sources' callback takes from the other readers: it ends first.
  for (const bool sources : {true, false}) {
    for (const auto& endpoint : impl_->endpoints) {
      if ((&endpoint->topic() == &topics::kSessionSources) == sources) {
        endpoint->close_reader(*impl_->subscriber);
      }
    }
  }
}

std::set<std::string> Bus::matched_peers(const topics::Topic& topic) const {
  std::set<std::string> peers;
  for (const auto& endpoint : impl_->endpoints) {
    if (&endpoint->topic() == &topic) peers.merge(endpoint->matched_services());
  }
  return peers;
}

std::vector<ParticipantId> Bus::matched_as(const topics::Topic& topic,
                                           const std::string& service) const {
  std::vector<ParticipantId> participants;
  for (const auto& endpoint : impl_->endpoints) {
    if (&endpoint->topic() != &topic) continue;
    std::ranges::copy(endpoint->matched_as(service), std::back_inserter(participants));
  }
  return participants;
}

std::vector<std::string> Bus::missing_peers() const {
  std::vector<std::string> missing;
  for (const auto& endpoint : impl_->endpoints) {
    const topics::Topic& row = endpoint->topic();
    const std::set<std::string> matched = endpoint->matched_services();
    for (const std::string_view wanted : endpoint->writes() ? row.readers : row.writers) {
      if (wanted == options_.service || wanted == topics::kDashboard) continue;
      if (matched.count(std::string(wanted)) != 0) continue;
      missing.push_back(std::string(wanted) + " (" + std::string(row.name) + ")");
    }
  }
  if (Impl::one_source(options_) && options_.service != "experiment" && missing.empty() &&
      !impl_->sources.named()) {
    missing.emplace_back(impl_->sources.contested()
                             ? "a single experiment: two name the session's sources"
                             : "experiment (to name the session's sources)");
  }
  return missing;
}

ParticipantId Bus::participant() const {
  ParticipantId own{};
  std::ranges::copy(impl_->participant->guid().guidPrefix.value, own.begin());
  return own;
}

std::vector<Source> Bus::sources_found() const { return impl_->peers.sources_found(participant()); }
bool Bus::speaks_for(std::string_view service, const ParticipantId& from) const noexcept {
  return !Impl::one_source(options_) || impl_->sources.speaks_for(service, from);
}
bool Bus::take_sources(const ParticipantId& from, const std::vector<Source>& sources) {
  if (!impl_->peers.take_sources(from, sources)) return false;
  for (const auto& endpoint : impl_->endpoints) endpoint->take_waiting();
  return true;
}

std::vector<std::string> Bus::duplicate_peers() const { return impl_->peers.duplicates(); }
bool Bus::peers_alive() const noexcept { return impl_->peers.alive(); }
const char* Bus::why_not_alive() const noexcept { return impl_->peers.why_not_alive(); }
bool Bus::replay_present() const noexcept { return impl_->peers.replay_present(); }
std::vector<std::string> Bus::lost_peers() const { return impl_->peers.lost(); }
void Bus::set_clock_offset(const std::string& service, std::int64_t offset_ns) {
  // The service name in a message is not proof: only offsets of the session's services are kept.
  if (std::ranges::find(topics::kServices, service) == topics::kServices.end()) return;
  const std::lock_guard lock(impl_->clock_mutex);
  impl_->clock_offsets_ns[service] = offset_ns;
  const auto own = impl_->clock_offsets_ns.find(options_.service);
  const std::int64_t own_ns = own == impl_->clock_offsets_ns.end() ? 0 : own->second;
  for (const auto& endpoint : impl_->endpoints) {
    const auto& writers = endpoint->topic().writers;
    if (endpoint->writes() || writers.size() != 1) continue;
    const auto writer = impl_->clock_offsets_ns.find(std::string(writers.front()));
    if (writer != impl_->clock_offsets_ns.end()) {
      endpoint->set_clock_ahead(difference_ns(writer->second, own_ns));
    }
  }
}

void Bus::supervise(bool on) noexcept { impl_->supervising.store(on, std::memory_order_relaxed); }

void Bus::note_silence() {
  for (const auto& endpoint : impl_->endpoints) endpoint->note_silence();
}

std::vector<EndpointReport> Bus::report() const {
  std::vector<EndpointReport> reports;
  for (const auto& endpoint : impl_->endpoints) reports.push_back(endpoint->report());
  return reports;
}

}  // namespace stillhand::runtime

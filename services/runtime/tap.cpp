// SPDX-License-Identifier: Apache-2.0
#include "runtime/tap.hpp"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <map>
#include <mutex>
#include <set>
#include <sstream>
#include <thread>

#include "idl/topics.hpp"
#include "runtime/bus.hpp"
#include "runtime/discovered_qos.hpp"
#include "runtime/participant.hpp"
#include "runtime/replay_mark.hpp"
#include "runtime/serialized_type.hpp"
#include "runtime/type_tag.hpp"

namespace stillhand::runtime {

using eprosima::fastrtps::rtps::GuidPrefix_t;
using eprosima::fastrtps::rtps::InstanceHandle_t;
using eprosima::fastrtps::rtps::ParticipantDiscoveryInfo;
using eprosima::fastrtps::rtps::WriterDiscoveryInfo;
using eprosima::fastrtps::types::ReturnCode_t;
namespace edds = eprosima::fastdds::dds;

namespace {

/// What a reader asks for; a writer belongs to the reader of its own class.
enum class ReaderClass : std::uint8_t { kBestEffort, kReliable, kReliableLatched };

ReaderClass class_of(const WriterQos& qos) {
  if (!qos.reliable) return ReaderClass::kBestEffort;
  return qos.durability == Durability::kVolatile ? ReaderClass::kReliable
                                                 : ReaderClass::kReliableLatched;
}

const char* profile_of(ReaderClass reader_class) {
  switch (reader_class) {
    case ReaderClass::kBestEffort:
      return "record_stream";
    case ReaderClass::kReliable:
      return "record_reliable";
    case ReaderClass::kReliableLatched:
      return "event";
  }
  return "";
}

std::int64_t system_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return now.tv_sec * kNsPerSecond + now.tv_nsec;
}

}  // namespace

struct Tap::Impl final : edds::DomainParticipantListener {
  using ReaderKey = std::pair<std::string, ReaderClass>;
  struct Reader;

  explicit Impl(Options given) : options(std::move(given)) {}

  void on_participant_discovery(edds::DomainParticipant* participant,
                                ParticipantDiscoveryInfo&& info) override;
  void on_publisher_discovery(edds::DomainParticipant* participant,
                              WriterDiscoveryInfo&& info) override;
  void note_writer(const eprosima::fastrtps::rtps::WriterProxyData& data);
  void open_readers(const std::stop_token& stop);
  void open_reader(const ReaderKey& key, const std::string& type);
  void tell(std::string line);
  /// With what discovery does not tell.
  [[nodiscard]] FoundWriter complete(FoundWriter writer) const {
    const auto depth = depth_of.find(writer.profile);
    if (depth != depth_of.end()) writer.qos.depth = depth->second;
    return writer;
  }

  Options options;
  mutable std::mutex mutex;
  std::condition_variable_any wake;
  std::deque<FoundWriter> writers;
  std::map<InstanceHandle_t, std::size_t> by_handle;
  std::map<GuidPrefix_t, std::string> participants;
  std::set<ReaderKey> asked_for;
  std::deque<std::pair<ReaderKey, std::string>> waiting;
  std::vector<std::string> trouble;
  std::atomic<std::uint64_t> unattributed{0};
  std::map<std::string, std::int32_t> depth_of;  // by profile; complete before the first reader

  // Of the opening thread alone.
  std::map<std::string, edds::Topic*> topics;
  std::vector<std::unique_ptr<Reader>> readers;
  edds::DomainParticipant* participant = nullptr;
  edds::Subscriber* subscriber = nullptr;
  std::jthread opening;
};

struct Tap::Impl::Reader final : edds::DataReaderListener {
  Reader(Impl& owner_, ReaderKey key_) : owner(owner_), key(std::move(key_)) {}

  void on_data_available(edds::DataReader* source) override {
    edds::SampleInfo info;
    while (source->take_next_sample(&sample, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data || !find(info.publication_handle) || !current_is_mine) continue;
      owner.options.on_sample(
          told.at(current),
          {current, static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long()),
           info.source_timestamp.to_ns(), system_ns(), sample});
    }
  }

  void on_requested_incompatible_qos(edds::DataReader* /*reader*/,
                                     const edds::RequestedIncompatibleQosStatus& status) override {
    // A writer of another class is another reader's.
    if (status.last_policy_id == edds::RELIABILITY_QOS_POLICY_ID ||
        status.last_policy_id == edds::DURABILITY_QOS_POLICY_ID) {
      return;
    }
    owner.tell(key.first + ": a writer offers what no reader here asks for (QoS policy " +
               std::to_string(status.last_policy_id) + ")");
  }

  /// Sets `current`; the writer of most samples is that of the one before.
  bool find(const InstanceHandle_t& handle) {
    if (handle == handle_now) return true;
    const std::lock_guard lock(owner.mutex);
    const auto found = owner.by_handle.find(handle);
    if (found == owner.by_handle.end()) {
      owner.unattributed.fetch_add(1, std::memory_order_relaxed);
      return false;
    }
    handle_now = handle;
    current = found->second;
    const FoundWriter& writer = owner.writers[current];
    current_is_mine = class_of(writer.qos) == key.second;
    if (told.count(current) == 0) told.emplace(current, owner.complete(writer));
    return true;
  }

  Impl& owner;
  ReaderKey key;
  edds::DataReader* reader = nullptr;
  SerializedSample sample;
  InstanceHandle_t handle_now;
  std::size_t current = 0;
  bool current_is_mine = false;
  std::map<std::size_t, FoundWriter> told;  // as known at the writer's first sample
};

void Tap::Impl::on_participant_discovery(edds::DomainParticipant* /*participant*/,
                                         ParticipantDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex);
  const auto prefix = info.info.m_guid.guidPrefix;
  const bool here = info.status == ParticipantDiscoveryInfo::DISCOVERED_PARTICIPANT ||
                    info.status == ParticipantDiscoveryInfo::CHANGED_QOS_PARTICIPANT;
  if (here) participants[prefix] = info.info.m_participantName.to_string();
  for (const auto& [handle, index] : by_handle) {
    if (eprosima::fastrtps::rtps::iHandle2GUID(handle).guidPrefix != prefix) continue;
    if (here) {
      writers[index].participant = participants[prefix];
    } else {
      writers[index].present = false;
    }
  }
}

void Tap::Impl::on_publisher_discovery(edds::DomainParticipant* /*participant*/,
                                       WriterDiscoveryInfo&& info) {
  const std::lock_guard lock(mutex);
  const InstanceHandle_t handle(info.info.guid());
  if (info.status == WriterDiscoveryInfo::REMOVED_WRITER) {
    if (const auto found = by_handle.find(handle); found != by_handle.end()) {
      writers[found->second].present = false;
    }
  } else if (by_handle.count(handle) == 0) {
    note_writer(info.info);
  }
}

void Tap::Impl::note_writer(const eprosima::fastrtps::rtps::WriterProxyData& data) {
  FoundWriter writer;
  writer.topic = data.topicName().to_string();
  writer.type = data.typeName().to_string();
  std::ostringstream id;
  id << data.guid();
  writer.id = id.str();
  if (const auto name = participants.find(data.guid().guidPrefix); name != participants.end()) {
    writer.participant = name->second;
  }
  writer.qos = discovered_qos(data.m_qos);
  writer.replayed = is_replay_mark(data.m_qos.m_userData.data_vec());
  writer.type_known = find_type(writer.type) != nullptr;
  writer.wanted = options.wanted(writer.topic);
  if (const topics::Topic* row = topics::find(writer.topic); row != nullptr) {
    writer.profile = std::string(topics::profile_of(row->pattern));
  }
  const ReaderKey key{writer.topic, class_of(writer.qos)};
  const bool open = writer.wanted && writer.type_known && asked_for.insert(key).second;
  if (writer.wanted && !data.m_qos.m_partition.names().empty()) {
    trouble.push_back(writer.topic + ": a writer in the partition \"" +
                      data.m_qos.m_partition.names().front() + "\" is not heard");
  }
  if (open) waiting.emplace_back(key, writer.type);
  by_handle.emplace(InstanceHandle_t(data.guid()), writers.size());
  writers.push_back(std::move(writer));
  if (open) wake.notify_all();
}

// DDS holds locks of its own while it tells of a writer, so readers are made in this thread.
void Tap::Impl::open_readers(const std::stop_token& stop) {
  for (;;) {
    std::pair<ReaderKey, std::string> next;
    {
      std::unique_lock lock(mutex);
      if (!wake.wait(lock, stop, [this] { return !waiting.empty(); })) return;
      next = std::move(waiting.front());
      waiting.pop_front();
    }
    open_reader(next.first, next.second);
  }
}

void Tap::Impl::open_reader(const ReaderKey& key, const std::string& type) {
  const std::string& name = key.first;
  if (topics.count(name) == 0) {
    const edds::TypeSupport carrier(new SerializedType(find_type(type)->support));
    carrier.register_type(participant);
    topics[name] = participant->create_topic(name, type, edds::TOPIC_QOS_DEFAULT);
  }
  if (topics[name] == nullptr || topics[name]->get_type_name() != type) {
    return tell(name + ": there with two types, " + type + " is not recorded");
  }
  edds::DataReaderQos qos;
  if (subscriber->get_datareader_qos_from_profile(profile_of(key.second), qos) !=
      ReturnCode_t::RETCODE_OK) {
    return tell(name + ": no data_reader profile \"" + profile_of(key.second) + "\" in " +
                options.profiles.string());
  }
  auto reader = std::make_unique<Reader>(*this, key);
  reader->reader = subscriber->create_datareader(topics[name], qos, reader.get());
  if (reader->reader == nullptr) return tell(name + ": Fast DDS refused a reader");
  readers.push_back(std::move(reader));
}

void Tap::Impl::tell(std::string line) {
  const std::lock_guard lock(mutex);
  if (std::find(trouble.begin(), trouble.end(), line) == trouble.end()) {
    trouble.push_back(std::move(line));
  }
}

Tap::Tap(Options options) : impl_(std::make_unique<Impl>(std::move(options))) {
  // Checked before the run: the readers themselves come when their writers do.
  impl_->participant = create_participant(impl_->options.profiles, impl_->options.domain,
                                          impl_->options.name, false, impl_.get());
  impl_->subscriber = impl_->participant->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT);
  edds::Publisher* profiles = impl_->participant->create_publisher(edds::PUBLISHER_QOS_DEFAULT);
  if (impl_->subscriber == nullptr || profiles == nullptr) {
    throw BusError("Fast DDS gave no subscriber");
  }
  // HISTORY does not travel in discovery: the catalogue's profiles tell it.
  for (const topics::Topic* row : topics::kCatalogue) {
    const std::string name(topics::profile_of(row->pattern));
    const std::optional<WriterQos> qos = profile_qos(*profiles, name);
    if (!qos) throw missing_profile(impl_->options.profiles, "data_writer", name);
    impl_->depth_of[name] = qos->depth;
  }
  for (const auto each :
       {ReaderClass::kBestEffort, ReaderClass::kReliable, ReaderClass::kReliableLatched}) {
    edds::DataReaderQos qos;
    if (impl_->subscriber->get_datareader_qos_from_profile(profile_of(each), qos) !=
        ReturnCode_t::RETCODE_OK) {
      throw missing_profile(impl_->options.profiles, "data_reader", profile_of(each));
    }
  }
  impl_->opening =
      std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->open_readers(stop); });
}

Tap::~Tap() {
  stop();
  impl_->participant->delete_contained_entities();
  edds::DomainParticipantFactory::get_instance()->delete_participant(impl_->participant);
}

void Tap::stop() {
  if (impl_->opening.joinable()) {
    impl_->opening.request_stop();
    impl_->opening.join();
  }
  for (const auto& reader : impl_->readers) {
    if (reader->reader != nullptr) impl_->subscriber->delete_datareader(reader->reader);
    reader->reader = nullptr;
  }
}

std::vector<FoundWriter> Tap::writers() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<FoundWriter> all;
  for (const FoundWriter& writer : impl_->writers) all.push_back(impl_->complete(writer));
  return all;
}

std::vector<std::string> Tap::trouble() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->trouble;
}

std::uint64_t Tap::unattributed() const {
  return impl_->unattributed.load(std::memory_order_relaxed);
}

}  // namespace stillhand::runtime

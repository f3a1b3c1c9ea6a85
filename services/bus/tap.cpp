// SPDX-License-Identifier: Apache-2.0
#include "services/bus/tap.hpp"

#include <algorithm>
#include <array>
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
#include <thread>

#include "fast_dds/discovery.hpp"
#include "idl/topics.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/discovered_qos.hpp"
#include "services/bus/found_writers.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/serialized_sample.hpp"
#include "services/system/process/log_clock.hpp"

namespace stillhand::runtime {

namespace {

/// What a reader requests; a writer belongs to the reader of its own class.
enum class ReaderClass : std::uint8_t { kBestEffort, kReliable, kReliableLatched };

ReaderClass class_of(const WriterQos& qos) {
  if (!qos.reliable) return ReaderClass::kBestEffort;
  return qos.durability == Durability::kVolatile ? ReaderClass::kReliable
                                                 : ReaderClass::kReliableLatched;
}

// Topics of strangers: each costs a reader.
constexpr std::size_t kMostForeign = 1000;

const char* profile_of(ReaderClass reader_class) {
  constexpr std::array kProfiles{"record_stream", "record_reliable", "event"};
  return kProfiles.at(static_cast<std::size_t>(reader_class));
}

}  // namespace

struct Tap::Impl final : DiscoveryListener {
  using ReaderKey = std::pair<std::string, ReaderClass>;
  struct Reader;

  explicit Impl(Options given) : options(std::move(given)) {}
  // Also when the constructor of Tap throws: the participant calls this as long as it is there.
  ~Impl() override {
    if (participant == nullptr) return;
    participant->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void on_participant(const AnnouncedParticipant& announced) override {
    writers.note_participant(announced);
  }
  void on_writer(const AnnouncedWriter& announced) override;
  void open_readers(const std::stop_token& stop);
  void open_reader(const ReaderKey& key, const FoundWriter& writer);
  void report(std::string line);
  void note(std::string line);  // the same with the mutex locked

  Options options;
  FoundWriters writers;
  mutable std::mutex mutex;
  std::condition_variable_any wake;
  std::set<ReaderKey> asked_for;
  std::deque<std::pair<ReaderKey, FoundWriter>> waiting;  // each reader's first writer
  std::vector<std::string> trouble;
  std::atomic<std::uint64_t> unattributed{0};

  // Of the opening thread alone.
  std::map<std::string, edds::Topic*> topics;
  std::vector<std::unique_ptr<Reader>> readers;
  edds::DomainParticipant* participant = nullptr;
  edds::Subscriber* subscriber = nullptr;
  std::jthread opening;
};

struct Tap::Impl::Reader final : edds::DataReaderListener {
  Reader(Impl& owner_, ReaderKey key_)
      : owner(owner_), key(std::move(key_)), writer_of(owner.writers) {}

  void on_data_available(edds::DataReader* source) override {
    edds::SampleInfo info;
    while (ok(source->take_next_sample(&sample, &info))) {
      const SampleWriters::Entry* entry = writer_of.of(info.publication_handle);
      const auto sequence =
          static_cast<std::int64_t>(info.sample_identity.sequence_number().to64long());
      if (entry == nullptr && info.valid_data) {
        owner.unattributed.fetch_add(1, std::memory_order_relaxed);
      }
      if (entry == nullptr || class_of(entry->writer.qos) != key.second) continue;
      if (!info.valid_data) {
        if (owner.options.on_instance_end) owner.options.on_instance_end(entry->number, sequence);
        continue;
      }
      const std::int64_t received_ns = monotonic_ns();
      owner.options.on_sample(entry->writer,
                              {entry->number, sequence, info.source_timestamp.to_ns(),
                               log_ns(received_ns), received_ns, sample});
    }
  }

  void on_requested_incompatible_qos(edds::DataReader* /*reader*/,
                                     const edds::RequestedIncompatibleQosStatus& status) override {
    // A writer of another class belongs to another reader.
    if (status.last_policy_id == edds::RELIABILITY_QOS_POLICY_ID ||
        status.last_policy_id == edds::DURABILITY_QOS_POLICY_ID) {
      return;
    }
    owner.report(key.first + ": the QoS of a writer matches no reader (QoS policy " +
                 std::to_string(status.last_policy_id) + ")");
  }

  Impl& owner;
  ReaderKey key;
  edds::DataReader* reader = nullptr;
  SerializedSample sample;
  SampleWriters writer_of;
};

void Tap::Impl::on_writer(const AnnouncedWriter& found) {
  AnnouncedWriter announced = found;
  if (announced.idl.empty() && options.idl_of) announced.idl = options.idl_of(announced.type);
  const auto number = writers.note_writer(announced, options.wanted(announced.topic));
  if (!number) return;
  const FoundWriter writer = writers.at(*number);
  if (!writer.wanted) return;
  const auto& partitions = announced.qos.m_partition.names();
  const ReaderKey key{writer.topic, class_of(writer.qos)};
  // A stranger's type under a name of the catalogue would keep the real one out.
  const bool read =
      writer.type_known || (options.any_type && topics::find(writer.topic) == nullptr);
  const std::lock_guard lock(mutex);
  if (!partitions.empty()) {
    note(writer.topic + ": a writer in the partition \"" + partitions.front() +
         "\" is not received");
  }
  if (read && writer.qos.xcdr2 && !kHasXcdr2) {
    note(writer.topic + ": a writer that offers XCDR 2 is not received: Fast DDS 2 " +
         "requests plain CDR alone");
  }
  if (!read || asked_for.count(key) != 0) return;
  if (!writer.type_known && asked_for.size() >= kMostForeign) {
    return note("of so many topics some are not received");
  }
  asked_for.insert(key);
  waiting.emplace_back(key, writer);
  wake.notify_all();
}

// DDS holds its own locks while it announces a writer, so readers are created in this thread.
void Tap::Impl::open_readers(const std::stop_token& stop) {
  for (;;) {
    std::pair<ReaderKey, FoundWriter> next;
    {
      std::unique_lock lock(mutex);
      if (!wake.wait(lock, stop, [this] { return !waiting.empty(); })) return;
      next = std::move(waiting.front());
      waiting.pop_front();
    }
    open_reader(next.first, next.second);
  }
}

void Tap::Impl::open_reader(const ReaderKey& key, const FoundWriter& writer) {
  const std::string& name = key.first;
  const std::string& type = writer.type;
  if (topics.count(name) == 0) {
    const edds::TypeSupport carrier = carrier_of(type, writer.qos.keyed);
    carrier.register_type(participant);
    topics[name] = participant->create_topic(name, type, edds::TOPIC_QOS_DEFAULT);
  }
  if (topics[name] == nullptr || topics[name]->get_type_name() != type) {
    return report(name + ": the topic has two types; " + type + " is not recorded");
  }
  edds::DataReaderQos qos;
  if (!ok(subscriber->get_datareader_qos_from_profile(profile_of(key.second), qos))) {
    return report(name + ": no data_reader profile \"" + profile_of(key.second) + "\" in " +
                  options.profiles.string());
  }
  announce(representation(qos), {edds::XCDR_DATA_REPRESENTATION, edds::XCDR2_DATA_REPRESENTATION});
  if (!writer.type_known) {  // with any number of keys
    qos.resource_limits().max_instances = edds::LENGTH_UNLIMITED;
    qos.resource_limits().max_samples = edds::LENGTH_UNLIMITED;
  }
  auto reader = std::make_unique<Reader>(*this, key);
  reader->reader = subscriber->create_datareader(topics[name], qos, reader.get());
  if (reader->reader == nullptr) return report(name + ": Fast DDS refused a reader");
  readers.push_back(std::move(reader));
}

void Tap::Impl::report(std::string line) {
  const std::lock_guard lock(mutex);
  note(std::move(line));
}

void Tap::Impl::note(std::string line) {
  if (std::find(trouble.begin(), trouble.end(), line) == trouble.end()) {
    trouble.push_back(std::move(line));
  }
}

Tap::Tap(Options options) : impl_(std::make_unique<Impl>(std::move(options))) {
  // Profiles are checked before the run; the readers are created when their writers are found.
  impl_->participant =
      create_participant(impl_->options.profiles, impl_->options.domain, impl_->options.name, false,
                         {impl_->options.security, std::string(topics::kTap)}, impl_.get());
  impl_->subscriber = impl_->participant->create_subscriber(edds::SUBSCRIBER_QOS_DEFAULT);
  edds::Publisher* profiles = impl_->participant->create_publisher(edds::PUBLISHER_QOS_DEFAULT);
  if (impl_->subscriber == nullptr || profiles == nullptr) {
    throw BusError("Fast DDS created no subscriber");
  }
  impl_->writers.learn_depths(*profiles, impl_->options.profiles);
  for (const auto each :
       {ReaderClass::kBestEffort, ReaderClass::kReliable, ReaderClass::kReliableLatched}) {
    edds::DataReaderQos qos;
    if (!ok(impl_->subscriber->get_datareader_qos_from_profile(profile_of(each), qos))) {
      throw missing_profile(impl_->options.profiles, "data_reader", profile_of(each));
    }
  }
}

void Tap::start() {
  impl_->opening =
      std::jthread([impl = impl_.get()](const std::stop_token& stop) { impl->open_readers(stop); });
}

Tap::~Tap() { stop(); }

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

std::vector<FoundWriter> Tap::writers() const { return impl_->writers.all(); }

std::vector<std::string> Tap::trouble() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->trouble;
}

std::uint64_t Tap::unattributed() const {
  return impl_->unattributed.load(std::memory_order_relaxed);
}

}  // namespace stillhand::runtime

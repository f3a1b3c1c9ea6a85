// SPDX-License-Identifier: Apache-2.0
#include "services/bus/playback.hpp"

#include <algorithm>
#include <atomic>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <map>
#include <vector>

#include "fast_dds/discovery.hpp"
#include "services/bus/bus.hpp"
#include "services/bus/discovered_qos.hpp"
#include "services/bus/found_writers.hpp"
#include "services/bus/participant.hpp"
#include "services/bus/replay_mark.hpp"
#include "services/bus/serialized_sample.hpp"
#include "services/bus/type_tag.hpp"

namespace stillhand::runtime {

namespace {

// Fast DDS 2.9.1 crashes on a missed offered deadline when the writer has no listener of its own.
struct Writer final : edds::DataWriterListener {
  void on_publication_matched(edds::DataWriter* /*writer*/,
                              const edds::PublicationMatchedStatus& status) override {
    matched.store(static_cast<std::uint32_t>(status.current_count), std::memory_order_relaxed);
  }
  void on_offered_deadline_missed(edds::DataWriter* /*writer*/,
                                  const edds::OfferedDeadlineMissedStatus& /*status*/) override {}

  edds::DataWriter* writer = nullptr;
  std::atomic<std::uint32_t> matched{0};
};

}  // namespace

struct Playback::Impl final : DiscoveryListener {
  Impl() = default;
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() override {
    if (participant == nullptr) return;  // it was refused
    participant->delete_contained_entities();
    edds::DomainParticipantFactory::get_instance()->delete_participant(participant);
  }

  void on_participant(const AnnouncedParticipant& announced) override {
    found.note_participant(announced);
  }
  void on_writer(const AnnouncedWriter& announced) override { found.note_writer(announced); }

  FoundWriters found;
  std::vector<std::unique_ptr<Writer>> writers;
  std::map<std::string, edds::Topic*> topics;
  edds::DomainParticipant* participant = nullptr;
  edds::Publisher* publisher = nullptr;
  SerializedSample sample;
};

Playback::Playback(const std::filesystem::path& profiles, std::uint32_t domain,
                   const std::string& name)
    : impl_(std::make_unique<Impl>()) {
  impl_->participant = create_participant(profiles, domain, name, true, {}, impl_.get());
  impl_->publisher = impl_->participant->create_publisher(edds::PUBLISHER_QOS_DEFAULT);
  if (impl_->publisher == nullptr) throw BusError("Fast DDS created no publisher");
}

Playback::~Playback() = default;
Playback::Playback(Playback&&) noexcept = default;

bool Playback::knows(const std::string& type) { return find_type(type) != nullptr; }

bool Playback::offers(const WriterQos& qos) { return kHasXcdr2 || !qos.xcdr2; }

std::optional<WriterQos> Playback::profile(const std::string& name) const {
  return profile_qos(*impl_->publisher, name);
}

std::size_t Playback::add_writer(const std::string& topic, const std::string& type,
                                 const WriterQos& wanted) {
  edds::Topic*& known = impl_->topics[topic];
  if (known == nullptr) {
    const edds::TypeSupport carrier = carrier_of(type, wanted.keyed);
    carrier.register_type(impl_->participant);
    known = impl_->participant->create_topic(topic, type, edds::TOPIC_QOS_DEFAULT);
  }
  if (known == nullptr || known->get_type_name() != type) {
    throw BusError("Fast DDS refused the topic " + topic + " of type " + type);
  }
  edds::DataWriterQos qos = offered_qos(wanted);
  qos.user_data().data_vec(replay_mark());
  auto writer = std::make_unique<Writer>();
  writer->writer = impl_->publisher->create_datawriter(known, qos, writer.get());
  if (writer->writer == nullptr) throw BusError("Fast DDS refused the writer of " + topic);
  impl_->writers.push_back(std::move(writer));
  return impl_->writers.size() - 1;
}

bool Playback::write(std::size_t writer, std::span<const std::byte> bytes) {
  impl_->sample.assign(bytes.begin(), bytes.end());
  return ok(impl_->writers[writer]->writer->write(&impl_->sample));
}

std::map<std::string, std::string> Playback::other_writers() const {
  std::map<std::string, std::string> names;
  for (const FoundWriter& each : impl_->found.all()) {
    if (!each.present || each.replayed) continue;
    names[each.topic] = each.participant.empty() ? each.id : each.participant;
  }
  return names;
}

std::uint32_t Playback::matched(std::size_t writer) const {
  return impl_->writers[writer]->matched.load(std::memory_order_relaxed);
}

bool Playback::wait_for_acknowledgments(std::int64_t limit_ns) {
  const std::int64_t end_ns = monotonic_ns() + limit_ns;
  return std::all_of(impl_->writers.begin(), impl_->writers.end(), [&](const auto& writer) {
    const std::int64_t left_ns = std::max<std::int64_t>(end_ns - monotonic_ns(), 0);
    return ok(writer->writer->wait_for_acknowledgments(
        {static_cast<std::int32_t>(left_ns / kNsPerSecond),
         static_cast<std::uint32_t>(left_ns % kNsPerSecond)}));
  });
}

}  // namespace stillhand::runtime

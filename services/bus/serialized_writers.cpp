// SPDX-License-Identifier: Apache-2.0
#include "services/bus/serialized_writers.hpp"

#include <algorithm>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>

#include "services/bus/bus.hpp"

namespace stillhand::runtime {

void SerializedWriters::Writer::on_publication_matched(
    edds::DataWriter* /*writer*/, const edds::PublicationMatchedStatus& status) {
  matched.store(static_cast<std::uint32_t>(status.current_count), std::memory_order_relaxed);
}

SerializedWriters::SerializedWriters(edds::DomainParticipant* participant)
    : participant_(participant),
      publisher_(participant->create_publisher(edds::PUBLISHER_QOS_DEFAULT)) {
  if (publisher_ != nullptr) return;
  edds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  throw BusError("Fast DDS created no publisher");
}

SerializedWriters::~SerializedWriters() {
  participant_->delete_contained_entities();
  edds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

std::size_t SerializedWriters::add(const std::string& topic, const std::string& type, bool keyed,
                                   const edds::DataWriterQos& qos) {
  edds::Topic*& known = topics_[topic];
  if (known == nullptr) {
    const edds::TypeSupport carrier = carrier_of(type, keyed);
    carrier.register_type(participant_);
    known = participant_->create_topic(topic, type, edds::TOPIC_QOS_DEFAULT);
  }
  if (known == nullptr || known->get_type_name() != type) {
    throw BusError("Fast DDS refused the topic " + topic + " of type " + type);
  }
  auto writer = std::make_unique<Writer>();
  writer->writer = publisher_->create_datawriter(known, qos, writer.get());
  if (writer->writer == nullptr) throw BusError("Fast DDS refused the writer of " + topic);
  writers_.push_back(std::move(writer));
  return writers_.size() - 1;
}

bool SerializedWriters::write(std::size_t writer, std::span<const std::byte> bytes) {
  sample_.assign(bytes.begin(), bytes.end());
  return ok(writers_[writer]->writer->write(&sample_));
}

std::uint32_t SerializedWriters::matched(std::size_t writer) const {
  return writers_[writer]->matched.load(std::memory_order_relaxed);
}

bool SerializedWriters::wait_for_acknowledgments(std::int64_t limit_ns) {
  const std::int64_t end_ns = monotonic_ns() + limit_ns;
  return std::all_of(writers_.begin(), writers_.end(), [&](const auto& writer) {
    const std::int64_t left_ns = std::max<std::int64_t>(end_ns - monotonic_ns(), 0);
    return ok(writer->writer->wait_for_acknowledgments(
        {static_cast<std::int32_t>(left_ns / kNsPerSecond),
         static_cast<std::uint32_t>(left_ns % kNsPerSecond)}));
  });
}

}  // namespace stillhand::runtime

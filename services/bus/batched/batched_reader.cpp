// SPDX-License-Identifier: Apache-2.0
#include "services/bus/batched/batched_reader.hpp"

#include <cstring>
#include <memory>
#include <utility>

#include "services/bus/batched/batched_udp.hpp"
#include "services/bus/batched/rtps_sample.hpp"
#include "services/system/process/clock.hpp"

namespace stillhand::runtime {

void BatchedReader::install(edds::DomainParticipantQos& qos) {
  const auto take = [this](auto datagram, auto arrived_ns) {
    return this->take(datagram, arrived_ns);
  };
  for (auto& transport : qos.transport().user_transports) {
    if (auto udp = std::dynamic_pointer_cast<ertps::UDPv4TransportDescriptor>(transport)) {
      transport = std::make_shared<BatchedUdpDescriptor>(std::move(udp), take);
    }
  }
}

void BatchedReader::start(const edds::DomainParticipant& participant) {
  const std::lock_guard lock(mutex_);
  own_ = participant.guid().guidPrefix;
  listening_ = true;
}

void BatchedReader::stop() {
  const std::lock_guard lock(mutex_);
  listening_ = false;
}

// nullptr: the writer's samples are Fast DDS's.
BatchedReader::Heard* BatchedReader::heard_of(const FoundWriters::Handle& handle) {
  if (const auto known = heard_.find(handle); known != heard_.end()) return &known->second;
  // Unknown are also the writers of discovery itself, which are never announced.
  const SampleWriters::Entry* entry = writer_of_.of(handle);
  if (entry == nullptr) return nullptr;
  const FoundWriter& writer = entry->writer;
  if (!writer.wanted || !writer.type_known || writer.qos.reliable) return nullptr;
  return &heard_.emplace(handle, Heard{entry, 0}).first->second;
}

bool BatchedReader::take(std::span<const std::byte> datagram, std::int64_t arrived_ns) {
  const auto sample = only_sample(datagram);
  if (!sample) return false;
  const std::lock_guard lock(mutex_);
  if (!listening_) return false;
  const auto* destination = reinterpret_cast<const ertps::octet*>(sample->destination.data());
  if (std::memcmp(destination, own_.value, ertps::GuidPrefix_t::size) != 0 &&
      sample->destination != RtpsSample{}.destination) {
    return false;
  }
  FoundWriters::Handle handle;
  std::memcpy(static_cast<ertps::octet*>(handle.value), sample->writer.data(),
              sample->writer.size());
  Heard* heard = heard_of(handle);
  if (heard == nullptr) return false;
  // A duplicate by another address, or overtaken by a newer sample.
  if (sample->sequence <= heard->newest) return true;
  heard->newest = sample->sequence;
  samples_.fetch_add(1, std::memory_order_relaxed);
  ertps::Time_t sent;
  sent.seconds(sample->sent_s);
  sent.fraction(sample->sent_fraction);
  on_sample_(heard->writer->writer, {heard->writer->number, sample->sequence, sent.to_ns(),
                                     arrived_ns, monotonic_ns(), sample->bytes});
  return true;
}

}  // namespace stillhand::runtime

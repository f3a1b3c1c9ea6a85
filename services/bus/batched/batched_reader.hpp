// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <functional>
#include <map>
#include <mutex>
#include <span>

#include "services/bus/found_writers.hpp"

namespace stillhand::runtime {

/// Takes the samples of best-effort writers from the datagrams before Fast DDS sees them, Tap's
/// Options::batched.  Everything else goes on to Fast DDS: discovery, reliable topics, datagrams
/// with more than one sample.  Duplicates and overtaken samples are dropped, as by a best-effort
/// reader of Fast DDS.  See README, "Batched UDP".
///
/// install() before the participant is created, start() once, stop() before the participant is
/// deleted.  on_sample() runs in the thread of BatchedUdp.
class BatchedReader {
 public:
  using OnSample = std::function<void(const FoundWriter&, const TappedSample&)>;

  /// @param writers  outlives this
  BatchedReader(FoundWriters& writers, OnSample on_sample)
      : writer_of_(writers), on_sample_(std::move(on_sample)) {}

  /// Replaces UDPv4 of a participant's QoS by BatchedUdp.
  void install(edds::DomainParticipantQos& qos);
  void start(const edds::DomainParticipant& participant);
  /// No on_sample() runs after this returns.
  void stop();
  [[nodiscard]] std::uint64_t samples() const { return samples_.load(std::memory_order_relaxed); }

 private:
  struct Heard {
    const SampleWriters::Entry* writer = nullptr;
    std::int64_t newest = 0;  // sequence number
  };

  bool take(std::span<const std::byte> datagram, std::int64_t arrived_ns);
  Heard* heard_of(const FoundWriters::Handle& handle);

  std::mutex mutex_;
  bool listening_ = false;
  ertps::GuidPrefix_t own_;
  SampleWriters writer_of_;
  OnSample on_sample_;
  std::map<FoundWriters::Handle, Heard> heard_;
  std::atomic<std::uint64_t> samples_{0};
};

}  // namespace stillhand::runtime

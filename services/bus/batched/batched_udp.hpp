// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <span>
#include <thread>
#include <vector>

#include "fast_dds/transport.hpp"

namespace stillhand::runtime {

/// Receives every datagram before DDS does.
/// @param arrived_ns  [ns] system clock, the kernel's stamp
/// @returns true to keep the datagram from DDS
using TakeDatagram =
    std::function<bool(std::span<const std::byte> datagram, std::int64_t arrived_ns)>;

/// UDPv4 for a listener to many topics: one thread reads every socket each 4 ms, many datagrams a
/// call.  Fast DDS's own transport sleeps in a call for each datagram, and every *sender* pays for
/// waking it (README, "Batched UDP").  The kernel's stamp says when a datagram arrived, so the wait
/// does not appear in a latency.  Sending and multicast groups stay Fast DDS's.
struct BatchedUdpDescriptor final : ertps::ChainingTransportDescriptor {
  BatchedUdpDescriptor(std::shared_ptr<ertps::UDPv4TransportDescriptor> udp_, TakeDatagram take_)
      : ChainingTransportDescriptor(udp_), udp(std::move(udp_)), take(std::move(take_)) {}

  [[nodiscard]] ertps::TransportInterface* create_transport() const override;

  std::shared_ptr<ertps::UDPv4TransportDescriptor> udp;
  TakeDatagram take;
};

class BatchedUdp final : public SendingAsBelow {
 public:
  using Locator = ertps::Locator_t;
  using Receiver = ertps::TransportReceiverInterface;

  explicit BatchedUdp(const BatchedUdpDescriptor& descriptor);
  ~BatchedUdp() override;

  ertps::TransportDescriptorInterface* get_configuration() override;
  bool IsInputChannelOpen(const Locator& locator) const override;
  bool OpenInputChannel(const Locator& locator, Receiver* receiver, std::uint32_t most) override;
  bool CloseInputChannel(const Locator& locator) override;
  void receive(Receiver* next, const ertps::octet* bytes, std::uint32_t size, const Locator& local,
               const Locator& remote) override;

 private:
  struct Channel;
  class Slots;

  void run(const std::stop_token& stop);
  /// @returns the number of datagrams
  std::size_t take_batch(const Channel& channel, int socket, Slots& slots);

  BatchedUdpDescriptor descriptor_;
  mutable std::mutex mutex_;
  std::vector<std::shared_ptr<Channel>> channels_;
  std::jthread reading_;
};

}  // namespace stillhand::runtime

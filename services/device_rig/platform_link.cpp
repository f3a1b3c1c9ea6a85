// SPDX-License-Identifier: Apache-2.0
#include "services/device_rig/platform_link.hpp"

#include <array>

#include "services/runtime/process/clock.hpp"

namespace stillhand::device_rig {

PlatformLink::PlatformLink(const PlatformLinkConfig& config, Parts::Platform protocol)
    : config_(config),
      protocol_(protocol),
      socket_(config.address, static_cast<std::uint16_t>(config.port),
              static_cast<std::uint16_t>(config.local_port)),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

PlatformLink::~PlatformLink() {
  thread_.request_stop();
  bell_.ring();
}

void PlatformLink::demand(const SetPoint& set_point) noexcept {
  demands_.store({++demand_number_, set_point});
  bell_.ring();
}

void PlatformLink::work(const std::stop_token& stop) noexcept {
  constexpr int kLook_ms = 100;
  while (!stop.stop_requested()) {
    bell_.wait(socket_.descriptor(), kLook_ms);
    receive();
    const Demand& demand = demands_.load();
    if (demand.number == sent_number_) continue;
    sent_number_ = demand.number;
    send(demand.set_point);
  }
  send({.follow = false, .position_m = sample_.reply.position_m});
}

void PlatformLink::receive() noexcept {
  std::array<std::uint8_t, 256> bytes{};
  // A sender without a pause does not hold the thread.
  for (int turn = 0; turn < 16; ++turn) {
    const auto datagram = socket_.receive(bytes);
    if (datagram.empty()) return;
    const PlatformReply reply = protocol_ == Parts::Platform::kMoog
                                    ? moog::read_reply(datagram, machine_state_)
                                    : plain::read_reply(datagram);
    // A sequence that stands is a packet that comes again; Moog's packets have none.
    const bool again = protocol_ == Parts::Platform::kPlain && sample_.count > 0 &&
                       reply.sequence == sample_.reply.sequence;
    if (!reply.whole || again) {
      ++sample_.damaged;
      continue;
    }
    ++sample_.count;
    sample_.at_ns = runtime::monotonic_ns();
    sample_.reply = reply;
    samples_.store(sample_);
  }
}

void PlatformLink::send(const SetPoint& set_point) noexcept {
  const Packet packet = protocol_ == Parts::Platform::kMoog
                            ? moog::command_packet(set_point, machine_state_, config_.heave_m)
                            : plain::command_packet(set_point, ++sequence_,
                                                    static_cast<std::uint32_t>(config_.valid_ms));
  // What is not taken is lost, as any datagram may be; the platform brakes after `valid_ms`.
  socket_.send(packet.payload());
}

}  // namespace stillhand::device_rig

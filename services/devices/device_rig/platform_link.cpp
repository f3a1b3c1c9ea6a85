// SPDX-License-Identifier: Apache-2.0
#include "services/devices/device_rig/platform_link.hpp"

#include <array>
#include <random>
#include <string>

#include "services/system/process/clock.hpp"

namespace stillhand::device_rig {

namespace {

// No two processes that command at one time have the same.
std::uint32_t new_token() {
  std::random_device device;
  return device() | 1u;
}

}  // namespace

PlatformLink::PlatformLink(const PlatformLinkConfig& config, Parts::Platform protocol)
    : lock_("platform-" + config.address + ":" + std::to_string(config.port),
            "platform at " + config.address + ", port " + std::to_string(config.port)),
      token_(new_token()),
      valid_ns_(config.valid_ms * 1'000'000),
      socket_(config.address, static_cast<std::uint16_t>(config.port),
              static_cast<std::uint16_t>(config.local_port)),
      exchange_(protocol, token_, static_cast<std::uint32_t>(config.valid_ms), config.heave_m),
      thread_([this](const std::stop_token& stop) { work(stop); }) {}

PlatformLink::~PlatformLink() {
  thread_.request_stop();
  bell_.ring();
}

void PlatformLink::demand(const SetPoint& set_point) noexcept {
  demands_.store({++demand_number_, runtime::monotonic_ns(), set_point});
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
    // After a process that stood still: a way that old is not gone on with.  To hold is never late.
    const bool fresh = runtime::monotonic_ns() - demand.at_ns < valid_ns_;
    if (fresh || demand.set_point.order != PlatformOrder::kFollow) send(demand.set_point);
  }
  if (sent_number_ == 0) return;
  SetPoint last = demands_.load().set_point;
  if (last.order == PlatformOrder::kFollow) last.order = PlatformOrder::kHold;
  send(last);
}

void PlatformLink::receive() noexcept {
  std::array<std::uint8_t, 256> bytes{};
  // A sender without a pause does not hold the thread.
  for (int turn = 0; turn < 16; ++turn) {
    const auto datagram = socket_.receive(bytes);
    if (datagram.empty()) return;
    if (exchange_.take(datagram, runtime::monotonic_ns())) samples_.store(exchange_.sample());
  }
}

void PlatformLink::send(const SetPoint& set_point) noexcept {
  const Packet packet = exchange_.command(set_point, runtime::monotonic_ns());
  // What is not taken is lost, as any datagram may be; the platform brakes after `valid_ms`.
  socket_.send(packet.payload());
}

}  // namespace stillhand::device_rig

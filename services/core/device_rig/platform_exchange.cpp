// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/platform_exchange.hpp"

namespace stillhand::device_rig {

Packet PlatformExchange::command(const SetPoint& set_point, std::int64_t now_ns) noexcept {
  if (protocol_ == Parts::Platform::kMoog) {
    return moog::command_packet(set_point, machine_state_, heave_m_);
  }
  sent_ns_[++sequence_ % kKept] = now_ns;
  return plain::command_packet(set_point, sequence_, token_, valid_ms_);
}

bool PlatformExchange::refuse() noexcept {
  ++sample_.damaged;
  return false;
}

bool PlatformExchange::take(std::span<const std::uint8_t> datagram, std::int64_t now_ns) noexcept {
  const bool plain = protocol_ == Parts::Platform::kPlain;
  const PlatformReply reply =
      plain ? plain::read_reply(datagram) : moog::read_reply(datagram, machine_state_);
  if (!reply.whole) return refuse();
  std::int64_t at_ns = now_ns;
  if (plain) {
    // A sequence that stands is a packet that comes again; Moog's packets have none.
    if (sample_.count > 0 && reply.sequence == sample_.reply.sequence) return refuse();
    const std::uint32_t ago = sequence_ - reply.answers;
    if (ago >= kKept || ago >= sequence_) return refuse();  // 0 answers none
    at_ns = sent_ns_[reply.answers % kKept];
  }
  if (at_ns < sample_.at_ns) return refuse();
  ++sample_.count;
  sample_.at_ns = at_ns;
  sample_.reply = reply;
  return true;
}

}  // namespace stillhand::device_rig

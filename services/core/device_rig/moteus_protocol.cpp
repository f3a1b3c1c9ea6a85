// SPDX-License-Identifier: Apache-2.0
#include "services/core/device_rig/moteus_protocol.hpp"

#include <fmt/format.h>

namespace stillhand::device_rig::moteus {

std::string_view MoteusProtocol::order(Order order, double torque_n_m) noexcept {
  switch (order) {
    case Order::kStop:
      return packed(stop_frame());
    case Order::kTorque:
      return packed(torque_frame({.torque_n_m = torque_n_m,
                                  .max_torque_n_m = config_.max_torque_n_m,
                                  .watchdog_s = config_.watchdog_s}));
    case Order::kQuery:
      break;
  }
  return packed(query_frame());
}

std::string_view MoteusProtocol::ask(std::string_view name) noexcept {
  answer_.clear();
  return packed(ask_setting(name));
}

std::string_view MoteusProtocol::ask_serial() noexcept {
  serial_.reset();
  return packed(serial_frame());
}

std::optional<std::string> MoteusProtocol::serial() const {
  if (!serial_) return std::nullopt;
  return fmt::format("{:08x}-{:08x}-{:08x}", (*serial_)[2], (*serial_)[1], (*serial_)[0]);
}

void MoteusProtocol::take_frame(std::uint32_t identifier, const Frame& frame,
                                DriveListener& listener) noexcept {
  constexpr std::uint32_t kNumber = 0x7f;
  if ((identifier >> 8 & kNumber) != static_cast<std::uint32_t>(config_.id)) return;
  FrameReader reader(frame.payload());
  bool console = false;
  while (const auto item = reader.next()) {
    if (item->kind != FrameReader::Kind::kConsole) continue;
    console = true;
    answer_.take(item->console);
  }
  if (console) return;
  if (const auto serial = read_serial(frame.payload())) {
    serial_ = serial;
    return;
  }
  const DriveReply reply = read_reply(frame.payload());
  if (reply.whole) {
    listener.state(reply);
  } else {
    listener.damaged();
  }
}

void MoteusLines::take(std::string_view bytes, DriveListener& listener) noexcept {
  splitter_.take(bytes, [&](std::string_view line) {
    const Received received = read_line(line, checked_);
    if (received.kind == Received::Kind::kDamaged) listener.damaged();
    if (received.kind == Received::Kind::kFrame) {
      take_frame(received.identifier, received.frame, listener);
    }
  });
}

std::string_view MoteusLines::packed(const Frame& frame) noexcept {
  line_ = send_line(destination(), frame, checked_);
  return line_.view();
}

}  // namespace stillhand::device_rig::moteus

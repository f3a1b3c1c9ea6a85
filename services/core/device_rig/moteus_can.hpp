// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "services/core/device_rig/can_record.hpp"
#include "services/core/device_rig/moteus_protocol.hpp"

namespace stillhand::device_rig::moteus {

/// A moteus drive on a CAN interface of the kernel, METHOD Eq. DR-34: what MoteusLines carries as
/// text goes as a frame.
class MoteusCan final : public MoteusProtocol {
 public:
  using MoteusProtocol::MoteusProtocol;

  /// Frames have no state between them.
  void clear() noexcept override {}
  /// @param bytes  one read of a socket: one frame
  void take(std::string_view bytes, DriveListener& listener) noexcept override {
    if (const auto read = read_record(bytes)) {
      take_frame(read->identifier, read->frame, listener);
    } else {
      listener.damaged();
    }
  }

 private:
  std::string_view packed(const Frame& frame) noexcept override {
    record_ = record_of(destination(), frame);
    return record_.view();
  }

  CanRecord record_;
};

}  // namespace stillhand::device_rig::moteus

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "services/core/contract/tick.hpp"

namespace stillhand::recording {

/// First fields of every 1 kHz message of idl/control_loop.idl.
struct SampleHead {
  std::uint32_t rig = 0;
  Tick tick = -1;  ///< -1: the bytes are another message
  std::int64_t stamp_ns = 0;
};

/// Reads these fields from CDR: 4 bytes of encapsulation (the second is 1 for little-endian), then
/// rig (4), padding (4), tick (8), stamp (8).  The offsets follow the CDR alignment rules, OMG
/// CORBA 3.x 15.3.
inline SampleHead sample_head(std::span<const std::byte> cdr) noexcept {
  constexpr std::size_t kHeadBytes = 4 + 24;
  if (cdr.size() < kHeadBytes || cdr[1] != std::byte{1}) return {};
  SampleHead head;
  std::memcpy(&head.rig, cdr.data() + 4, sizeof(head.rig));
  std::memcpy(&head.tick, cdr.data() + 12, sizeof(head.tick));
  std::memcpy(&head.stamp_ns, cdr.data() + 20, sizeof(head.stamp_ns));
  return head;
}

}  // namespace stillhand::recording

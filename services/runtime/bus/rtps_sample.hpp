// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace stillhand::runtime {

/// The one sample of a datagram, where it holds nothing else.
struct RtpsSample {
  std::array<std::byte, 12> destination{};  ///< GUID prefix that it is meant for; 0: everybody's
  std::array<std::byte, 16> writer{};       ///< GUID
  std::int64_t sequence = 0;                ///< [-] the writer counts from 1
  std::int32_t sent_s = 0;                  ///< [s] system clock of the writer's host, whole
  std::uint32_t sent_fraction = 0;          ///< [2^-32 s]
  std::span<const std::byte> bytes;         ///< CDR with encapsulation header, inside the datagram
};

/// An RTPS message of one DATA with a time stamp and nothing that asks for an answer: what a
/// best-effort writer sends a sample in; a vendor's own parts are passed over.  RTPS 2.3, 8.3.7
/// and 9.4.  Everything else is nullopt and DDS's own business: discovery, heartbeats, fragments,
/// disposed instances, protected messages, other byte orders, and what is no RTPS.  Pure.
std::optional<RtpsSample> only_sample(std::span<const std::byte> datagram) noexcept;

}  // namespace stillhand::runtime

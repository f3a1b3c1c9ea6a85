// SPDX-License-Identifier: Apache-2.0
#include "services/bus/batched/rtps_sample.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

namespace stillhand::runtime {

namespace {

static_assert(std::endian::native == std::endian::little);

using Bytes = std::span<const std::byte>;

constexpr std::size_t kPrefix = 12, kEntity = 4, kHeader = 20, kSubmessageHeader = 4;
// From here on a vendor's own, passed over by others (9.4.5.1.1); Fast DDS ends each message with
// one.
constexpr std::uint8_t kVendors = 0x80;
constexpr std::uint8_t kInfoTimestamp = 0x09, kInfoDestination = 0x0e, kData = 0x15;
constexpr std::uint8_t kLittleEndian = 0x01, kInlineQos = 0x02, kHasData = 0x04;
constexpr std::uint8_t kInvalidate = 0x02;  // of a time stamp
constexpr std::size_t kDataHead = 20;       // flags, offset, reader, writer, sequence number
constexpr std::uint16_t kSentinel = 1;

/// The caller has looked that it lies inside.
template <typename Number>
Number at(Bytes bytes, std::size_t offset) noexcept {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof(number));
  return number;
}

bool take_timestamp(std::uint8_t flags, Bytes body, RtpsSample& sample) noexcept {
  if ((flags & kInvalidate) != 0 || body.size() < 8) return false;
  sample.sent_s = at<std::int32_t>(body, 0);
  sample.sent_fraction = at<std::uint32_t>(body, 4);
  return true;
}

/// Where the payload begins behind a list of parameters, or 0.
std::size_t behind_parameters(Bytes body, std::size_t offset) noexcept {
  while (offset + 4 <= body.size()) {
    const auto id = at<std::uint16_t>(body, offset);
    const auto length = at<std::uint16_t>(body, offset + 2);
    offset += 4;
    if (id == kSentinel) return offset;
    offset += length;
  }
  return 0;
}

bool take_data(std::uint8_t flags, Bytes body, RtpsSample& sample) noexcept {
  // A key alone, or something that is not of this version, is an end of an instance or unknown.
  if ((flags & ~(kLittleEndian | kInlineQos)) != kHasData || body.size() < kDataHead) return false;
  std::ranges::copy(body.subspan(8, kEntity), sample.writer.begin() + kPrefix);
  const auto high = at<std::int32_t>(body, 12);
  const auto low = at<std::uint32_t>(body, 16);
  sample.sequence = (static_cast<std::int64_t>(high) << 32) | low;
  std::size_t payload = 4 + std::size_t{at<std::uint16_t>(body, 2)};
  if (payload < kDataHead) return false;
  if ((flags & kInlineQos) != 0) payload = behind_parameters(body, payload);
  if (payload == 0 || payload >= body.size()) return false;
  sample.bytes = body.subspan(payload);
  return sample.sequence > 0;
}

}  // namespace

std::optional<RtpsSample> only_sample(Bytes datagram) noexcept {
  if (datagram.size() < kHeader || std::memcmp(datagram.data(), "RTPS", 4) != 0 ||
      datagram[4] != std::byte{2}) {
    return std::nullopt;
  }
  RtpsSample sample;
  std::ranges::copy(datagram.subspan(8, kPrefix), sample.writer.begin());
  bool stamped = false, found = false;
  for (Bytes rest = datagram.subspan(kHeader); !rest.empty();) {
    if (rest.size() < kSubmessageHeader) return std::nullopt;
    const auto id = at<std::uint8_t>(rest, 0);
    const auto flags = at<std::uint8_t>(rest, 1);
    std::size_t length = at<std::uint16_t>(rest, 2);
    rest = rest.subspan(kSubmessageHeader);
    if ((flags & kLittleEndian) == 0 || length > rest.size()) return std::nullopt;
    if (length == 0) length = rest.size();  // the last one may leave it out
    const Bytes body = rest.first(length);
    rest = rest.subspan(length);
    if (id >= kVendors) continue;
    if (found) return std::nullopt;
    if (id == kInfoDestination && body.size() >= kPrefix) {
      std::ranges::copy(body.first(kPrefix), sample.destination.begin());
    } else if (id == kInfoTimestamp && take_timestamp(flags, body, sample)) {
      stamped = true;
    } else if (id == kData && take_data(flags, body, sample)) {
      found = true;
    } else {
      return std::nullopt;
    }
  }
  if (!stamped || !found) return std::nullopt;
  return sample;
}

}  // namespace stillhand::runtime

// SPDX-License-Identifier: Apache-2.0
// Fast CDR 1.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <cstddef>

namespace stillhand::fast_cdr {

/// Plain CDR, XCDR 1, on a buffer.
struct PlainCdr : eprosima::fastcdr::Cdr {
  explicit PlainCdr(eprosima::fastcdr::FastBuffer& buffer) : Cdr(buffer, DEFAULT_ENDIAN, DDS_CDR) {}
  [[nodiscard]] std::size_t length() const { return getSerializedDataLength(); }
};

template <typename Message>
void write(PlainCdr& cdr, const Message& message) {
  message.serialize(cdr);
}

/// @returns false when the bytes end before the message  @throws Exception likewise
template <typename Message>
bool read(PlainCdr& cdr, std::size_t /*bytes*/, Message& message) {
  message.deserialize(cdr);
  return true;
}

}  // namespace stillhand::fast_cdr

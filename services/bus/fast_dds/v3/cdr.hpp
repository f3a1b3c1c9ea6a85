// SPDX-License-Identifier: Apache-2.0
// Fast CDR 2.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <cstddef>

namespace stillhand::fast_cdr {

/// Plain CDR, XCDR 1, on a buffer.
struct PlainCdr : eprosima::fastcdr::Cdr {
  explicit PlainCdr(eprosima::fastcdr::FastBuffer& buffer)
      : Cdr(buffer, DEFAULT_ENDIAN, eprosima::fastcdr::CdrVersion::XCDRv1) {
    set_encoding_flag(eprosima::fastcdr::EncodingAlgorithmFlag::PLAIN_CDR);
  }
  [[nodiscard]] std::size_t length() const { return get_serialized_data_length(); }
};

template <typename Message>
void write(PlainCdr& cdr, const Message& message) {
  cdr << message;
}

/// @param bytes  all that `cdr` holds, encapsulation included
/// @returns false when the bytes end before the message  @throws Exception likewise
// Fast CDR 2 takes an end between two fields for the end of the message, and leaves the fields
// behind it as they were: written again, such a message is longer.  Its own calculation of a size
// adds padding that an empty sequence does not have.
template <typename Message>
bool read(PlainCdr& cdr, std::size_t bytes, Message& message) {
  cdr >> message;
  if (cdr.length() < bytes) return true;
  thread_local eprosima::fastcdr::FastBuffer room;  // grows for the first messages alone
  PlainCdr again(room);
  again.serialize_encapsulation();
  again << message;
  return again.length() <= bytes;
}

}  // namespace stillhand::fast_cdr

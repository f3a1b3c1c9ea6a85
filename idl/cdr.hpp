// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <cstddef>
#include <span>

namespace stillhand {

/// Decodes one message from its recorded bytes: CDR with the 4-byte encapsulation header.
/// @return false if the bytes are another message; `message` is then unspecified.
template <typename Message>
bool from_cdr(std::span<const std::byte> bytes, Message& message) {
  // Fast CDR only reads here, but its buffer type needs a non-const pointer.
  auto* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));
  eprosima::fastcdr::FastBuffer buffer(begin, bytes.size());
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::DEFAULT_ENDIAN,
                             eprosima::fastcdr::Cdr::DDS_CDR);
  try {
    cdr.read_encapsulation();
    message.deserialize(cdr);
    return true;
  } catch (const eprosima::fastcdr::exception::Exception&) {
    return false;
  }
}

}  // namespace stillhand

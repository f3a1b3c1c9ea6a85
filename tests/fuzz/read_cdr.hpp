// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>
#include <fastcdr/exceptions/Exception.h>

#include <optional>
#include <vector>

namespace stillhand::fuzz {

/// A message of a generated type on Fast CDR, as every process reads it from the bus.
template <typename Message>
std::optional<Message> read_cdr(std::vector<char>& bytes) {
  namespace cdr = eprosima::fastcdr;
  try {
    cdr::FastBuffer buffer(bytes.data(), bytes.size());
    cdr::Cdr in(buffer, cdr::Cdr::DEFAULT_ENDIAN, cdr::Cdr::DDS_CDR);
    in.read_encapsulation();
    Message message;
    message.deserialize(in);
    return message;
  } catch (const cdr::exception::Exception&) {
    return std::nullopt;
  }
}

}  // namespace stillhand::fuzz

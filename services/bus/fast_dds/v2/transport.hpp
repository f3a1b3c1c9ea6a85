// SPDX-License-Identifier: Apache-2.0
// Fast DDS 2.
#pragma once

#include <fastdds/rtps/transport/ChainingTransport.h>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.h>

#include "fast_dds/names.hpp"

namespace stillhand::runtime {

/// A chaining transport that sends as the one below it.
class SendingAsBelow : public ertps::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;
  bool send(ertps::SenderResource* sender, const ertps::octet* bytes, std::uint32_t size,
            ertps::LocatorsIterator* begin, ertps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) final {
    return sender->send(bytes, size, begin, end, timeout);
  }
};

}  // namespace stillhand::runtime

// SPDX-License-Identifier: Apache-2.0
// Fast DDS 3.
#pragma once

#include <fastdds/rtps/transport/ChainingTransport.hpp>
#include <fastdds/rtps/transport/ChainingTransportDescriptor.hpp>
#include <fastdds/rtps/transport/SenderResource.hpp>

#include "fast_dds/names.hpp"

namespace stillhand::runtime {

/// A chaining transport that sends as the one below it.
class SendingAsBelow : public ertps::ChainingTransport {
 public:
  using ChainingTransport::ChainingTransport;
  bool send(ertps::SenderResource* sender, const std::vector<ertps::NetworkBuffer>& buffers,
            std::uint32_t size, ertps::LocatorsIterator* begin, ertps::LocatorsIterator* end,
            const std::chrono::steady_clock::time_point& timeout) final {
    return sender->send(buffers, size, begin, end, timeout);
  }
};

}  // namespace stillhand::runtime

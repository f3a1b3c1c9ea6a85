// SPDX-License-Identifier: Apache-2.0
// Fast DDS 3.
#pragma once

#include <fastdds/dds/core/ReturnCode.hpp>
#include <fastdds/dds/publisher/qos/DataWriterQos.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/rtps/attributes/RTPSParticipantAttributes.hpp>
#include <fastdds/rtps/common/InstanceHandle.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.hpp>
#include <fastdds/utils/IPLocator.hpp>

namespace stillhand::runtime {

namespace edds = eprosima::fastdds::dds;
namespace ertps = eprosima::fastdds::rtps;

/// What Fast DDS returned is a success: its code of one is 0, so it must not be taken for a bool.
inline bool ok(edds::ReturnCode_t code) { return code == edds::RETCODE_OK; }
bool ok(bool) = delete;

inline edds::Duration_t& heartbeat_period(edds::DataWriterQos& qos) {
  return qos.reliable_writer_qos().times.heartbeat_period;
}

/// It announces its DATA_REPRESENTATION.
inline constexpr bool kHasXcdr2 = true;

inline auto& representation(edds::DataReaderQos& qos) { return qos.representation(); }

}  // namespace stillhand::runtime
